// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

/// A program of this project that the window runs. The window itself opens no device and writes no
/// file. Main context's thread.
class Command
{
public:
  struct Calls
  {
    std::function<void(const std::string &)> line; ///< of its standard output
    std::function<void(const std::string &)> told; ///< of its standard error
    /// Its end: empty, or the last line of its standard error.
    std::function<void(const std::string &complaint)> ended;
    bool ends_with_window = false; ///< SIGTERM at the window's end, however that ends
  };

  /// Of a program beside this one, else in $PATH. One that cannot be started ends with a complaint,
  /// soon.
  static std::shared_ptr<Command> start(std::vector<std::string> arguments, Calls calls);

  /// SIGTERM: the program brings all motors to zero, and ends.
  void stop();
  /// No further call.
  void forget();

private:
  struct Run;
  static void end(Run &run);
  static void part_ended(const std::shared_ptr<Run> &run);

  std::shared_ptr<Run> run_;
};
