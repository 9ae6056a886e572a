// SPDX-License-Identifier: LGPL-2.1-or-later
#include "audio_file.h"
#include "commands.h"
#include "options.h"
#include "session.h"

#include "calibration/calibration.h"
#include "calibration/tactor_calibration.h"
#include "film/or_throw.h"
#include "translation.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <stdexcept>

namespace {

std::string
now()
{
  g_autoptr(GDateTime) time = g_date_time_new_now_utc();
  g_autofree gchar *text = g_date_time_format(time, "%Y-%m-%dT%H:%M:%SZ");
  return text;
}

void
report(const tactor::Calibration &calibration, const std::vector<tactor::StepResponse> &responses)
{
  for (const auto &[index, tactor] : calibration.tactors) {
    std::printf(_("tactor %d: %d steps used, %d refused\n"), index, tactor.steps_used,
                tactor.steps_refused);
    if (tactor.latency)
      std::printf(_("  first motion after %.1f ms\n"),
                  static_cast<double>(tactor.latency->count()) / 1e6);
    std::printf(_("  starts at %.2f V, holds to %.2f V, falls in %.0f ms\n"), tactor.start_volts,
                tactor.hold_volts, static_cast<double>(tactor.fall_time.count()) / 1e6);
    if (tactor.quadratic) {
      const auto &c = tactor.quadratic->coefficients;
      std::printf(
          _("  rise time = %.1f %+.1f d %+.1f s %+.2f d2 %+.2f d s %+.2f s2 ms, R2 %.4f, residual "
            "%.1f ms; used: %s\n"),
          c[0], c[1], c[2], c[3], c[4], c[5], tactor.quadratic->r_squared,
          tactor.quadratic->residual_ms, tactor.prefers_quadratic ? "this" : "the table");
    }
  }
  std::map<std::pair<int, std::string>, int> refused;
  for (const tactor::StepResponse &response : responses)
    if (response.fault != tactor::StepFault::none && response.fault != tactor::StepFault::no_motion)
      refused[{ response.step.tactor, std::string(tactor::fault_name(response.fault)) }]++;
  for (const auto &[what, count] : refused)
    std::printf(_("tactor %d: %d steps refused: %s\n"), what.first, count, what.second.c_str());
  const auto hum = std::ranges::max_element(responses, {}, &tactor::StepResponse::hum);
  if (hum != responses.end() && hum->hum > 0)
    std::printf(_("mains hum of up to %.4g RMS was removed\n"), hum->hum);
}

} // namespace

int
analyze(int argc, char **argv)
{
  TextOption band;
  TextOption output;
  TextOption recording;
  TextOption commands;
  TextOption motor;
  gdouble offset_ms = 0;
  gboolean find = FALSE;
  gboolean verbose = FALSE;
  CommonOptions common;
  const GOptionEntry entries[] = {
    { "output", 'o', 0, G_OPTION_ARG_FILENAME, &output.value,
      N_("The calibration to write or replace (default: FOLDER/motors.calibration)"), "FILE" },
    { "band", 'b', 0, G_OPTION_ARG_STRING, &band.value,
      N_("Band to filter, such as 20:160, in Hz (default: detected)"), "LOW:HIGH" },
    { "recording", 0, 0, G_OPTION_ARG_FILENAME, &recording.value,
      N_("A single recording instead of FOLDER, with --commands and --output"), "FILE" },
    { "commands", 0, 0, G_OPTION_ARG_FILENAME, &commands.value,
      N_("Command trace of the recording, from tactorsink's property trace-location"), "FILE" },
    { "offset", 0, 0, G_OPTION_ARG_DOUBLE, &offset_ms,
      N_("Time of the recording's start in that trace (default: 0)"), "MS" },
    { "align", 0, 0, G_OPTION_ARG_NONE, &find,
      N_("Find each recording's start by correlation; leaves the latency unknown"), nullptr },
    { "motor", 'm', 0, G_OPTION_ARG_STRING, &motor.value, N_("Description of the motors"), "TEXT" },
    { "verbose", 'v', 0, G_OPTION_ARG_NONE, &verbose, N_("Print every step"), nullptr },
    {},
  };
  const std::vector<std::string> arguments = parse_options(
      argc, argv, entries, common,
      { .arguments = "[FOLDER]",
        .summary = N_("Analyzes the recordings in FOLDER, or a single one, and writes a "
                      "calibration.\nA recording is a sound file that GStreamer can decode, or a "
                      "CSV file of seconds\nand values."),
        .least = 0,
        .most = 1 });
  const bool single = recording.is_set() && commands.is_set() && output.is_set();
  if (arguments.size() != (single ? 0 : 1))
    throw UsageError(_("expected one FOLDER, or --recording, --commands and --output"));
  gst_init(nullptr, nullptr);

  Session::Heard heard;
  std::string sensor = "recording '" + recording.text() + "'";
  std::string name = motor.text();
  std::string path = output.text();
  if (single) {
    tactor::Recording sound = read_recording(recording.text());
    sound.start += tactor::Time(static_cast<gint64>(offset_ms * 1e6));
    const std::vector<tactor::IssuedCommand> trace
        = or_throw(tactor::read_command_trace(commands.text()));
    int tactors = 1;
    for (const tactor::IssuedCommand &issued : trace)
      tactors = std::max(tactors, issued.command.tactor + 1);
    heard = measure_recording(std::move(sound), trace, tactors, parse_band(band.text()), find);
  } else {
    const Session session = Session::open(arguments.front());
    heard = session.measure(parse_band(band.text()), find);
    sensor = session.sensor().empty() ? "recordings made elsewhere" : session.sensor();
    name = motor.is_set() ? name : session.motor();
    if (!output.is_set())
      path = arguments.front() + "/motors.calibration";
  }
  tactor::Calibration calibration = tactor::calibrate(heard.responses, heard.one_clock);
  if (verbose)
    for (const tactor::StepResponse &response : heard.responses)
      std::printf(_("tactor %d, %.2f to %.2f V: 90 %% after %.1f ms, first motion %.1f ms, level "
                    "%.4g, %.0f "
                    "dB; %s\n"),
                  response.step.tactor, response.step.start_volts, response.step.target_volts,
                  response.risen_ms, response.onset_ms, response.steady, response.snr_db,
                  std::string(tactor::fault_name(response.fault)).c_str());
  if (calibration.tactors.empty())
    throw std::runtime_error(in_text("no rise could be measured in {} steps; is the sensor on the "
                                     "motor? (--verbose prints the error of each)",
                                     std::to_string(heard.responses.size())));
  g_autofree gchar *method
      = g_strdup_printf("%s; band %.0f to %.0f Hz; %zu steps", sensor.c_str(), heard.band.low_hz,
                        heard.band.high_hz, heard.responses.size());
  calibration.motor = name;
  calibration.date = now();
  calibration.method = method;
  or_throw(tactor::write_calibration(calibration, path));
  if (common.quiet)
    return 0;
  report(calibration, heard.responses);
  std::printf(_("written: %s\n"), path.c_str());
  return 0;
}
