// SPDX-License-Identifier: LGPL-2.1-or-later
#include "commands.h"
#include "options.h"
#include "pictures.h"
#include "session.h"

#include <cmath>
#include <cstdio>
#include <stdexcept>

int
run_show(int argc, char **argv)
{
  TextOption band;
  TextOption output;
  gint tactor = 0;
  gdouble start = 0;
  gdouble target = -1;
  std::vector<std::string> arguments;
  if (!parse_options(
          argc, argv, "FOLDER",
          "Pictures of one tactor as SVG files: tactor-N-envelope.svg (a rise and its 90 %),\n"
          "tactor-N-rise-times.svg (all rise times and the fit), tactor-N-residuals.svg.",
          { { "output", 'o', 0, G_OPTION_ARG_FILENAME, &output.value, "Where to (default: FOLDER)",
              "DIR" },
            { "tactor", 't', 0, G_OPTION_ARG_INT, &tactor, "Which (default: 0)", "N" },
            { "from", 0, 0, G_OPTION_ARG_DOUBLE, &start, "Start voltage of the rise (default: 0)",
              "V" },
            { "to", 0, 0, G_OPTION_ARG_DOUBLE, &target, "Its target (default: the highest)", "V" },
            { "band", 'b', 0, G_OPTION_ARG_STRING, &band.value, "As for analyse", "LOW:HIGH" } },
          arguments))
    return 2;
  if (arguments.size() != 1) {
    std::fprintf(stderr, "tactor-calibrate: show expects one FOLDER\n");
    return 2;
  }
  const Session session = Session::open(arguments.front());
  Session::Heard heard = session.measure(parse_band(band.text()));
  std::vector<tactor::StepResponse> own;
  for (const tactor::StepResponse &response : heard.responses)
    if (response.step.tactor == tactor)
      own.push_back(response);
  const std::optional<tactor::TactorCalibration> calibration
      = tactor::calibrate_tactor(own, heard.one_clock);
  if (!calibration)
    throw std::runtime_error("tactor " + std::to_string(tactor)
                             + " has no rise that could be measured");

  // The nearest to what was asked for.
  const tactor::RecordedRun *run = nullptr;
  tactor::Step step;
  double nearest = 1e9;
  for (const tactor::RecordedRun &candidate : heard.runs)
    for (const tactor::Step &other : candidate.steps) {
      const double wanted = target >= 0 ? target : session.settings().volts_max;
      const double distance
          = std::abs(other.start_volts - start) + std::abs(other.target_volts - wanted);
      if (other.tactor != tactor || !other.rises() || distance >= nearest)
        continue;
      nearest = distance;
      run = &candidate;
      step = other;
    }
  if (!run)
    throw std::runtime_error("tactor " + std::to_string(tactor) + " has no rise");
  int tactors = 1;
  for (const int index : session.settings().tactors)
    tactors = std::max(tactors, index + 1);
  tactor::StepEnvelope envelope;
  const tactor::StepResponse response
      = tactor::measure_step(run->recording, run->recording.channel_of(tactor, tactors), step,
                             heard.band, tactor::prior_of(own), &envelope);

  const std::string folder = output.is_set() ? output.text() : arguments.front();
  const std::string stem = folder + "/tactor-" + std::to_string(tactor) + "-";
  const std::pair<std::string, std::string> pictures[] = {
    { stem + "envelope.svg", envelope_picture(response, envelope) },
    { stem + "rise-times.svg", surface_picture(*calibration, own) },
    { stem + "residuals.svg", residual_picture(*calibration, own) },
  };
  for (const auto &[path, picture] : pictures) {
    g_autoptr(GError) error = nullptr;
    if (!g_file_set_contents(path.c_str(), picture.c_str(), -1, &error))
      throw std::runtime_error(error->message);
    std::printf("written: %s\n", path.c_str());
  }
  return 0;
}
