// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace quality {

/// SplitMix64 (Steele, Lea, Flood 2014). Distributions of the standard library differ between
/// implementations, but films must be reproducible.
class Random
{
public:
  explicit Random(std::uint64_t seed) : state_(seed)
  {
  }

  /// In [low, high).
  double uniform(double low, double high)
  {
    return low + (high - low) * 0x1p-53 * static_cast<double>(next() >> 11U);
  }

  /// Mean 0, variance 1 (Box & Muller 1958).
  double normal()
  {
    const double radius = std::sqrt(-2 * std::log(1 - uniform(0, 1)));
    return radius * std::cos(2 * std::numbers::pi * uniform(0, 1));
  }

private:
  std::uint64_t next()
  {
    std::uint64_t x = state_ += 0x9e3779b97f4a7c15U;
    x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31U);
  }

  std::uint64_t state_;
};

} // namespace quality
