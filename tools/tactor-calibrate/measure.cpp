// SPDX-License-Identifier: LGPL-2.1-or-later
#include "commands.h"
#include "options.h"
#include "session.h"
#include "translation.h"

#include <cstdio>
#include <gst/gst.h>

using tactor::Time;

int
measure(int argc, char **argv)
{
  PlayOptions play_options;
  TextOption tactors("0");
  TextOption motor("");
  tactor::MeasurementSettings settings;
  gint only = -1;
  CommonOptions common;
  const std::vector<GOptionEntry> entries = play_options.with({
      { "tactors", 't', 0, G_OPTION_ARG_STRING, &tactors.value,
        N_("Tactors to measure, such as 0-8 or 0,2 (default: 0); a source with as many channels as "
           "tactors records each tactor on a channel of its own"),
        "LIST" },
      { "voltage-max", 0, 0, G_OPTION_ARG_DOUBLE, &settings.volts_max,
        N_("Voltage at the motor when the board's output is fully on (default: 3)"), "V" },
      { "step", 0, 0, G_OPTION_ARG_DOUBLE, &settings.step_volts,
        N_("Step between start and target voltages (default: 0.5; in the paper: 0.1)"), "V" },
      { "repetitions", 'r', 0, G_OPTION_ARG_INT, &settings.repetitions,
        N_("Repetitions of each step (default: 1)"), "N" },
      { "run", 0, 0, G_OPTION_ARG_INT, &only,
        N_("Record only this run, from 0 on, even if it is recorded already"), "N" },
      { "motor", 'm', 0, G_OPTION_ARG_STRING, &motor.value, N_("Description of the motors"),
        "TEXT" },
  });
  const std::vector<std::string> arguments = parse_options(
      argc, argv, entries.data(), common,
      { .arguments = "FOLDER",
        .summary = N_("Drives tactors through known steps of voltage, within the limits of "
                      "tactorsink, and\nrecords their vibration on the same clock. Each run takes "
                      "half a minute and writes a\nrecording and a command trace to FOLDER. Ctrl-C "
                      "stops all motors; the same command\ncontinues with the next run."),
        .least = 1,
        .most = 1,
        .force_help = N_("Record all runs again, also those that are recorded already") });
  gst_init(nullptr, nullptr);
  settings.tactors = parse_tactors(tactors.text());
  const PlayerSettings player = play_options.settings(settings.volts_max);
  const Session session = Session::begin(arguments.front(), settings, motor.text(), player.source);

  const auto is_wanted = [&](int run) {
    return only < 0 ? common.force || !session.is_done(run, !player.source.empty()) : run == only;
  };
  Time left{ 0 };
  for (int run = 0; run < session.runs(); run++)
    if (is_wanted(run))
      left += session.length(run);
  for (int run = 0; run < session.runs(); run++) {
    if (!is_wanted(run))
      continue;
    if (!common.quiet)
      std::printf(_("run %d of %d, %.0f s left\n"), run + 1, session.runs(),
                  std::chrono::duration<double>(left).count());
    std::fflush(stdout);
    session.keep(run, play(session.frames(run), player, interruption()));
    left -= session.length(run);
  }
  return 0;
}
