// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactor-calibrate: measures the motors of a chair, shows and checks what was measured.
#include "commands.h"

#include "film/command_line.h"
#include "translation.h"

#include <array>

static constexpr std::array kCommands = {
  Command{ "measure", measure, N_("drive tactors through known steps and record them") },
  Command{ "analyze", analyze, N_("make a calibration from recordings") },
  Command{ "show", show, N_("draw envelopes, rise times and residuals") },
  Command{ "check", check, N_("play a pattern and measure its timing error") },
};

int
main(int argc, char **argv)
{
  return run_commands("tactor-calibrate", kCommands, argc, argv);
}
