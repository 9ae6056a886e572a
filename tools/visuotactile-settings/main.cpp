// SPDX-License-Identifier: LGPL-2.1-or-later
//
// visuotactile-settings: the chair of players that have no setting for it.
#include "commands.h"

#include "film/command_line.h"
#include "house/translation.h"

#include <array>

static constexpr std::array kCommands = {
  Command{ "devices", devices, "print the connected devices, and faults" },
  Command{ "players", players, "print the players that can be switched on" },
  Command{ "list", list, "print all settings" },
  Command{ "on", switch_on, "enable the chair in players" },
  Command{ "off", switch_off, "disable the chair in players" },
  Command{ "set", set, "change settings" },
  Command{ "unset", unset, "remove settings" },
  Command{ "use", use, "choose a device" },
  Command{ "test", test, "drive one tactor after the other" },
};

int
main(int argc, char **argv)
{
  use_translations();
  return run_commands("visuotactile-settings", kCommands, argc, argv);
}
