// SPDX-License-Identifier: LGPL-2.1-or-later
//
// visuotactile-study: a laboratory's study of films with and without touch.
#include "commands.h"

#include "film/command_line.h"
#include "translation.h"

#include <array>

static constexpr std::array kCommands = {
  Command{ "new", make_new, N_("make a study's folder, with the paper's study") },
  Command{ "run", run_study, N_("serve sessions in the browser, with film and chair") },
  Command{ "status", print_status, N_("print the state of each participant") },
  Command{ "export", export_table, N_("write the answers as CSV") },
  Command{ "report", write_report, N_("analyze the answers (needs R)") },
  Command{ "power", compute_power, N_("compute how many people a study needs (needs R)") },
  Command{ "simulate", simulate, N_("write the data of simulated participants") },
  Command{ "forget", forget, N_("remove a participant's data") },
};

int
main(int argc, char **argv)
{
  return run_commands("visuotactile-study", kCommands, argc, argv);
}
