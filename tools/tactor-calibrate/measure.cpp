// SPDX-License-Identifier: LGPL-2.1-or-later
#include "commands.h"
#include "options.h"
#include "session.h"

#include <cstdio>

using tactor::Time;

int
run_measure(int argc, char **argv)
{
  PlayOptions play_options;
  TextOption tactors("0");
  TextOption motor("");
  tactor::MeasurementSettings settings;
  gint only = -1;
  Manner manner;
  std::vector<GOptionEntry> entries = play_options.entries();
  const GOptionEntry own[] = {
    { "tactors", 't', 0, G_OPTION_ARG_STRING, &tactors.value,
      "Which, as in 0-8 (default: 0). One sensor hears all of them; with as many channels as "
      "tactors each has "
      "its own",
      "LIST" },
    { "voltage-max", 0, 0, G_OPTION_ARG_DOUBLE, &settings.volts_max,
      "Volts at the motor when a board's output is fully on (default: 3)", "V" },
    { "step", 0, 0, G_OPTION_ARG_DOUBLE, &settings.step_volts,
      "Grid of start and target voltages (default: 0.5; the paper's: 0.1)", "V" },
    { "repetitions", 'r', 0, G_OPTION_ARG_INT, &settings.repetitions, "Of each step (default: 1)",
      "N" },
    { "run", 0, 0, G_OPTION_ARG_INT, &only, "Only this run, from 0, even if it is done already",
      "N" },
    { "motor", 'm', 0, G_OPTION_ARG_STRING, &motor.value, "Which motors they are, in words",
      "TEXT" },
  };
  entries.insert(entries.end(), std::begin(own), std::end(own));
  std::vector<std::string> arguments;
  if (!parse_options(
          argc, argv, "FOLDER",
          "Drives tactors through known steps and records them, one clock for both. What limits "
          "tactorsink keeps holds.\nFOLDER gets a recording and a list of commands for each run "
          "of half a minute. Ctrl-C stops all motors; the same\ncommand goes on with the next run.",
          std::move(entries),
          manner.entries("Measure anew what is done already", Manner::kSaysOnlyFaults), arguments))
    return 2;
  if (arguments.size() != 1) {
    std::fprintf(stderr, "tactor-calibrate: measure expects one FOLDER\n");
    return 2;
  }
  settings.tactors = parse_tactors(tactors.text());
  const PlayerSettings player = play_options.settings(settings.volts_max);
  const Session session = Session::begin(arguments.front(), settings, motor.text(), player.source);

  const auto is_wanted = [&](int run) {
    return only < 0 ? manner.force || !session.is_done(run, !player.source.empty()) : run == only;
  };
  Time left{ 0 };
  for (int run = 0; run < session.runs(); run++)
    if (is_wanted(run))
      left += session.frames(run).back().begin + session.frames(run).back().duration;
  for (int run = 0; run < session.runs(); run++) {
    if (!is_wanted(run))
      continue;
    const std::vector<Frame> frames = session.frames(run);
    if (!manner.quiet)
      std::printf("run %d of %d, %.0f s left\n", run + 1, session.runs(),
                  std::chrono::duration<double>(left).count());
    std::fflush(stdout);
    session.keep(run, play(frames, player, interruption()));
    left -= frames.back().begin + frames.back().duration;
  }
  return 0;
}
