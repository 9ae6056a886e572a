// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <array>
#include <charconv>
#include <string>

namespace tactile {

/// The shortest text of a level, with a decimal point in any locale.
inline std::string
decimal(float value)
{
  std::array<char, 32> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
  return { text.data(), end.ptr };
}

/// Seconds, to the millisecond.
inline std::string
seconds(std::chrono::milliseconds time)
{
  std::array<char, 40> text;
  const auto end
      = std::to_chars(text.data(), text.data() + text.size(),
                      static_cast<double>(time.count()) / 1000, std::chars_format::fixed, 3);
  return { text.data(), end.ptr };
}

} // namespace tactile
