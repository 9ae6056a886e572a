// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

/// Opens an address in the user's browser, and keeps it out of command lines, which other users can
/// read: the browser is given a file that only the user can read. The file is removed with the
/// object.
class Browser
{
public:
  Browser() = default;
  ~Browser();
  Browser(const Browser &) = delete;
  Browser &operator=(const Browser &) = delete;

  /// Why it cannot be opened; empty: it is.
  std::string open(const std::string &address);

private:
  std::string file_;
};
