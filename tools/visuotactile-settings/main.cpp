// SPDX-License-Identifier: LGPL-2.1-or-later
//
// visuotactile-settings: the chair of players that have no setting for it.
#include "commands.h"

#include "film/command_line.h"
#include "translation.h"

#include <array>

static constexpr std::array kCommands = {
  Command{ "devices", devices, N_("print the connected devices, and faults") },
  Command{ "players", players, N_("print the players that can be switched on") },
  Command{ "list", list, N_("print all settings") },
  Command{ "on", switch_on, N_("enable the chair in players") },
  Command{ "off", switch_off, N_("disable the chair in players") },
  Command{ "set", set, N_("change settings") },
  Command{ "unset", unset, N_("remove settings") },
  Command{ "use", use, N_("choose a device") },
  Command{ "test", test, N_("drive one tactor after the other") },
};

int
main(int argc, char **argv)
{
  return run_commands("visuotactile-settings", kCommands, argc, argv);
}
