// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace tactile {

/// Why something is no valid track or cue, or cannot be converted to one.
struct FormatError
{
  /// "line 12", "byte 345" or "channels[3]", with the name of a file in front of it; empty for the
  /// whole.
  std::string place;
  std::string reason; ///< one line at most

  static FormatError at_line(std::size_t line, std::string reason)
  {
    return { "line " + std::to_string(line), std::move(reason) };
  }
  static FormatError at_byte(std::size_t byte, std::string reason)
  {
    return { "byte " + std::to_string(byte), std::move(reason) };
  }

  /// The same error within something larger: "'film.csv': line 12".
  FormatError within(const std::string &whole) &&
  {
    place = place.empty() ? whole : whole + ": " + place;
    return std::move(*this);
  }

  /// Place and reason in one line.
  std::string text() const
  {
    return place.empty() ? reason : place + ": " + reason;
  }
};

/// The first error of a parser. A part that is invalid reports it here and yields zero or nothing
/// from then on. The caller checks it in each loop and at the end.
class FirstError
{
public:
  void set(FormatError error)
  {
    if (!error_)
      error_ = std::move(error);
  }

  /// Whether an error was set.
  explicit operator bool() const
  {
    return error_.has_value();
  }

  /// `whole`, or the first error.
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
