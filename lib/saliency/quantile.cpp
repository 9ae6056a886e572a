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

/// Numbers ≥ 0 are in the order of their bits: exponent and the first two of the mantissa.
constexpr std::size_t kBuckets = 1024;

/// That of 0 and of all that is below the normal numbers, which a processor may be told to take for
/// 0 (by any library that was built for fast mathematics).
constexpr std::size_t kZero = 3;

std::size_t
bucket(float value)
{
  return std::max<std::size_t>(kZero, std::bit_cast<std::uint32_t>(value) >> 21U & (kBuckets - 1));
}

/// The smallest number in a bucket.
float
least_of(std::size_t bucket)
{
  return bucket == kZero ? 0 : std::bit_cast<float>(static_cast<std::uint32_t>(bucket) << 21U);
}

} // namespace

float
quantile(std::vector<float> &values, double q)
{
  // Most are told apart by counting: noise would make a comparison sort guess wrong half of the
  // time.
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
