// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace tactile {

/// Iterates over the lines of a text with Unix, Windows or classic Mac line ends; skips a byte
/// order mark.
class LineReader
{
public:
  explicit LineReader(std::string_view text) : rest_(text)
  {
    if (rest_.starts_with("\xef\xbb\xbf"))
      rest_.remove_prefix(3);
  }

  /// Advances to the next line. False at the end; the line is empty then.
  bool next()
  {
    line_ = {};
    whole_ = {};
    if (rest_.empty())
      return false;
    const std::size_t length = std::min(rest_.find_first_of("\r\n"), rest_.size());
    const std::size_t end = rest_.substr(length).starts_with("\r\n") ? 2 : 1;
    line_ = rest_.substr(0, length);
    whole_ = rest_.substr(0, length + end);
    rest_.remove_prefix(whole_.size());
    number_++;
    return true;
  }

  /// The line without its line end.
  std::string_view line() const
  {
    return line_;
  }

  /// The line with its line end, if it has one.
  std::string_view whole() const
  {
    return whole_;
  }

  /// Line number, from 1.
  std::size_t number() const
  {
    return number_;
  }

private:
  std::string_view rest_;
  std::string_view line_;
  std::string_view whole_;
  std::size_t number_ = 0;
};

} // namespace tactile
