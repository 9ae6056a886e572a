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

/// The pattern of the bucket of 0 and of denormals, which count as 0: the CPU may flush them (any
/// library built with -ffast-math can set that mode).
constexpr std::uint32_t kZero = 3U << 21U;

/// So many values of a bucket are not counted by their next bits.
constexpr std::size_t kFew = 32;

std::uint32_t
pattern(float value)
{
  return std::bit_cast<std::uint32_t>(value);
}

std::size_t
bucket(float value)
{
  return std::max(kZero, pattern(value) & 0x7FFFFFFFU) >> 21U;
}

/// The smallest value that counts as one of at least this pattern.
float
least_of(std::uint32_t pattern)
{
  return pattern == kZero ? 0 : std::bit_cast<float>(pattern);
}

} // namespace

float
quantile(std::span<float> values, double q)
{
  // Count by bucket first: on noise, a comparison sort would mispredict half of its branches.
  auto place = static_cast<std::size_t>(q * static_cast<double>(values.size() - 1));
  const auto narrow = [&](std::uint32_t base, unsigned bits, const auto &index) {
    std::array<std::uint32_t, kBuckets> counts{};
    for (const float value : values)
      ++counts[index(value)];
    std::uint32_t wanted = 0;
    while (place >= counts[wanted])
      place -= counts[wanted++];
    wanted = base + (wanted << bits);
    values = values.first(rows::keep_between(least_of(wanted), least_of(wanted + (1U << bits)),
                                             values.size(), values.data()));
    return wanted;
  };
  const std::uint32_t found = narrow(0, 21, bucket);
  if (found == kZero)
    return 0;
  if (values.size() > kFew)
    narrow(found, 11, [](float value) { return pattern(value) >> 11U & (kBuckets - 1); });
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(place);
  std::ranges::nth_element(values, nth);
  return *nth;
}

} // namespace saliency
