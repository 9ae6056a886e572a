// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

/// How another program ended.
struct ProgramEnd
{
  int status = 0;        ///< of its exit; 128 + the signal that ended it
  std::string complaint; ///< the last line on its standard error
};

/// The user has stopped this program: exit status 130.
struct Stopped
{
};

/// While one exists, SIGINT, SIGTERM and SIGHUP stop the other program that runs, and make
/// signals_stop_here() throw. A signal that was ignored (nohup) stays so, in other programs, too.
/// Of one thread; one within another does nothing.
class SignalsStop
{
public:
  SignalsStop();
  ~SignalsStop();
  SignalsStop(const SignalsStop &) = delete;
  SignalsStop &operator=(const SignalsStop &) = delete;
};

/// Throws Stopped after such a signal.
void signals_stop_here();

/// Runs a program of $PATH to its end, in a locale with UTF-8, and calls `on_line` for each line of
/// its standard output. SIGINT, SIGTERM and SIGHUP, and the end of this process, end it. Throws
/// Stopped after a signal, std::runtime_error if there is no such program: `package` has it.
ProgramEnd run_program(const std::vector<std::string> &arguments, const char *package,
                       const std::function<void(std::string_view)> &on_line);
