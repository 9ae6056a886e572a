// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>

namespace visuotactile {

/// The finalizer of SplitMix64 (Steele, Lea, Flood 2014). Distributions of the standard library are
/// implementation-defined, but synthetic films and sounds have to be the same everywhere.
constexpr std::uint64_t
mix_bits(std::uint64_t x)
{
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

class Random
{
public:
  explicit Random(std::uint64_t seed) : state_(mix_bits(seed))
  {
  }

  double uniform(double low, double high)
  {
    return low + (high - low) * 0x1p-53 * static_cast<double>(next() >> 11U);
  }

  int below(int n)
  {
    return static_cast<int>(next() % static_cast<std::uint64_t>(n));
  }

private:
  std::uint64_t next()
  {
    return state_ = mix_bits(state_);
  }

  std::uint64_t state_;
};

} // namespace visuotactile
