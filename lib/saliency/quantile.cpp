// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/quantile.h"

#include "saliency/rows.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace saliency {

namespace {

/// Bit patterns of floats ≥ 0 sort like their values. A bucket is the exponent and two mantissa
/// bits.
constexpr std::size_t kBuckets = 1024;

/// The bucket of 0 and of denormals, which the CPU may flush to 0 (any library built with
/// -ffast-math can set that mode).
constexpr std::size_t kZero = 3;

std::size_t
bucket(float value)
{
  return std::max<std::size_t>(kZero, std::bit_cast<std::uint32_t>(value) >> 21U & (kBuckets - 1));
}

/// The smallest value in a bucket.
float
least_of(std::size_t bucket)
{
  return bucket == kZero ? 0 : std::bit_cast<float>(static_cast<std::uint32_t>(bucket) << 21U);
}

} // namespace

float
quantile(std::vector<float> &values, double q)
{
  // Count by bucket first: on noise, a comparison sort would mispredict half of its branches.
  auto place = static_cast<std::size_t>(q * static_cast<double>(values.size() - 1));
  std::array<std::uint32_t, kBuckets> counts{};
  for (const float value : values)
    ++counts[bucket(value)];
  std::size_t wanted = kZero;
  while (place >= counts[wanted])
    place -= counts[wanted++];
  values.resize(
      rows::keep_between(least_of(wanted), least_of(wanted + 1), values.size(), values.data()));
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(place);
  std::ranges::nth_element(values, nth);
  return *nth;
}

} // namespace saliency
