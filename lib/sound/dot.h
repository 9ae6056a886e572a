// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <cstddef>
#include <numeric>

namespace sound {

inline constexpr int kLanes = 8;

/// The sum of products, in an order that does not depend on the addresses of the samples. `count`:
/// a multiple of kLanes.
inline float
dot(const float *a, const float *b, int count)
{
  std::array<float, kLanes> sums{};
  for (int i = 0; i < count; i += kLanes)
    for (int lane = 0; lane < kLanes; lane++)
      sums[static_cast<std::size_t>(lane)] += a[i + lane] * b[i + lane];
  return std::accumulate(sums.begin(), sums.end(), 0.0F);
}

} // namespace sound
