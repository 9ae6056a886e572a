// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

/// Progress on standard error: on a terminal one line that is written over, else a line each time.
class Progress
{
public:
  Progress();
  ~Progress();
  Progress(const Progress &) = delete;
  Progress &operator=(const Progress &) = delete;

  bool is_on_terminal() const
  {
    return on_terminal_;
  }
  void show(const std::string &text);
  /// Before something else is printed.
  void clear();

private:
  bool on_terminal_;
  bool shown_ = false;
};
