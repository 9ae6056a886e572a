// SPDX-License-Identifier: LGPL-2.1-or-later
#include "listen/correlation.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace listen {

std::size_t
reference_steps(std::size_t onsets, double rate, int reach)
{
  return static_cast<std::size_t>(std::ceil(static_cast<double>(onsets) * rate)) + 1
         + 2 * static_cast<std::size_t>(reach);
}

Fit
fit(std::span<const Bands> onsets, std::span<const std::uint8_t> reference, double rate, int reach,
    int near)
{
  const std::size_t steps = reference_steps(onsets.size(), rate, reach);
  const auto places = static_cast<std::size_t>(2 * reach + 1);
  if (onsets.empty() || reference.size() < steps)
    return {};
  std::vector<float> signs(steps);
  std::vector<float> sums(places);
  for (std::size_t band = 0; band < kBands; band++) {
    for (std::size_t step = 0; step < steps; step++)
      signs[step] = (reference[step] >> band & 1U) != 0 ? 1.0F : -1.0F;
    const auto of = [&](std::size_t n) {
      return signs.data() + std::lround(static_cast<double>(n) * rate);
    };
    std::size_t n = 0;
    for (; n + 4 <= onsets.size(); n += 4) { // at once: sums are read and written seldom
      const std::array<float, 4> weights
          = { onsets[n][band], onsets[n + 1][band], onsets[n + 2][band], onsets[n + 3][band] };
      const std::array<const float *, 4> parts = { of(n), of(n + 1), of(n + 2), of(n + 3) };
      for (std::size_t place = 0; place < places; place++)
        sums[place] += weights[0] * parts[0][place] + weights[1] * parts[1][place]
                       + weights[2] * parts[2][place] + weights[3] * parts[3][place];
    }
    for (; n < onsets.size(); n++)
      for (std::size_t place = 0; place < places; place++)
        sums[place] += onsets[n][band] * of(n)[place];
  }
  const auto best = static_cast<std::size_t>(
      std::max_element(sums.begin() + reach - near, sums.begin() + reach + near + 1)
      - sums.begin());
  double mean = 0;
  double power = 0;
  int count = 0;
  for (std::size_t place = 0; place < places; place++)
    if (std::abs(static_cast<int>(place) - static_cast<int>(best)) > kPeakWidth) {
      mean += sums[place];
      power += sums[place] * sums[place];
      count++;
    }
  if (count < 2)
    return {};
  mean /= count;
  const double deviation = std::sqrt(std::max(power / count - mean * mean, 1e-12));
  double off = 0;
  if (best > 0 && best + 1 < places) {
    // The peak is nearly a triangle, because power is averaged over intervals.
    const double rise = sums[best] - std::min(sums[best - 1], sums[best + 1]);
    if (rise > 0)
      off = (sums[best + 1] - sums[best - 1]) / (2 * rise);
  }
  return { .step = static_cast<double>(best) + off, .score = (sums[best] - mean) / deviation };
}

} // namespace listen
