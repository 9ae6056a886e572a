// SPDX-License-Identifier: LGPL-2.1-or-later
//
// visuotactile-settings: the chair of players that have no setting for it.
#include "commands.h"

#include "film/command_line.h"

#include <array>

static constexpr std::array kCommands = {
  Command{ "list", list, "print all settings" },
  Command{ "on", switch_on, "enable the chair in players" },
  Command{ "off", switch_off, "disable the chair in players" },
  Command{ "set", set, "change settings" },
  Command{ "unset", unset, "remove settings" },
  Command{ "test", test, "drive one tactor after the other" },
};

int
main(int argc, char **argv)
{
  return run_commands("visuotactile-settings", kCommands, argc, argv);
}
