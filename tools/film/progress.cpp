// SPDX-License-Identifier: LGPL-2.1-or-later
#include "progress.h"

#include <cstdio>
#include <unistd.h>
#include <utility>

Progress::Progress() : on_terminal_(isatty(STDERR_FILENO))
{
}

Progress::~Progress()
{
  clear();
}

void
Progress::show(const std::string &text)
{
  std::fprintf(stderr, on_terminal_ ? "\r\033[K%s" : "%s\n", text.c_str());
  std::fflush(stderr);
  shown_ = true;
}

void
Progress::clear()
{
  if (std::exchange(shown_, false) && on_terminal_)
    std::fputs("\r\033[K", stderr);
}
