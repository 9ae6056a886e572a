// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <cstdint>

/// Frames per second as a fraction, with GStreamer's timestamps for such a film.
struct FrameRate
{
  std::int64_t numerator;
  std::int64_t denominator;

  tactor::Time frame(std::int64_t number) const
  {
    return tactor::Time(number * denominator * 1'000'000'000 / numerator);
  }
  tactor::Time duration(std::int64_t number) const
  {
    return frame(number + 1) - frame(number);
  }
};

inline constexpr FrameRate kThirty{ 30, 1 };
