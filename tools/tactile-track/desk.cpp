// SPDX-License-Identifier: LGPL-2.1-or-later
//
// desk: becomes tactile-track-desk, which has the HTTP server.
#include "commands.h"

#include "tactile-track-desk/options.h"
#include "translation.h"

#include <cerrno>
#include <cstring>
#include <unistd.h>

int
desk(int argc, char **argv)
{
  std::vector<char *> arguments(argv, argv + argc);
  arguments.push_back(nullptr);
  {
    DeskOptions options;
    UserDefaults none; // tactile-track-desk reads the settings
    read_desk_options(argc, argv, options, none);
  }
  const char *set = g_getenv("VISUOTACTILE_DESK");
  const std::string program = set ? set : DESK_PROGRAM;
  execv(program.c_str(), arguments.data());
  throw std::runtime_error(
      in_text("'{}' cannot be run: {}{}", program, g_strerror(errno),
              (errno == ENOENT ? "; it is installed with visuotactile-tools" : "")));
}
