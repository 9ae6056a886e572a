// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace tactile {

/// Why something is no track or cue, or cannot become one.
struct FormatError
{
  /// "line 12", "byte 345", "channels[3]", with a file's name before it if it is one; empty: all of
  /// it.
  std::string place;
  std::string reason; ///< fits a line

  static FormatError at_line(std::size_t line, std::string reason)
  {
    return { "line " + std::to_string(line), std::move(reason) };
  }
  static FormatError at_byte(std::size_t byte, std::string reason)
  {
    return { "byte " + std::to_string(byte), std::move(reason) };
  }

  /// The same in something larger: "'film.csv': line 12".
  FormatError within(const std::string &whole) &&
  {
    place = place.empty() ? whole : whole + ": " + place;
    return std::move(*this);
  }

  /// One line with both.
  std::string text() const
  {
    return place.empty() ? reason : place + ": " + reason;
  }
};

/// What is wrong with something that is read part by part: the first thing counts. A part that is
/// not what it has to be says so here and is a zero, or nothing, from then on; who reads the whole
/// asks in each loop and at the end.
class FirstError
{
public:
  void set(FormatError error)
  {
    if (!error_)
      error_ = std::move(error);
  }

  /// Whether there is one.
  explicit operator bool() const
  {
    return error_.has_value();
  }

  /// The whole, or why it is none.
  template <typename Whole> tl::expected<Whole, FormatError> unless_set(Whole &&whole) &&
  {
    if (error_)
      return tl::unexpected(std::move(*error_));
    return std::forward<Whole>(whole);
  }

private:
  std::optional<FormatError> error_;
};

} // namespace tactile
