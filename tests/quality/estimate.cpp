// SPDX-License-Identifier: LGPL-2.1-or-later
#include "estimate.h"

#include "random.h"
#include "table.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace quality {

namespace {

constexpr std::size_t kDraws = 2000;
constexpr double kTail = 0.025;

std::string
with_interval(const std::string &value, const Estimate &estimate, double scale, int digits)
{
  if (std::isnan(estimate.low))
    return value;
  return value + " [" + figure(scale * estimate.low, digits) + " "
         + figure(scale * estimate.high, digits) + "]";
}

} // namespace

Estimate
estimate(std::span<const Mean> units)
{
  std::vector<Mean> filled;
  std::ranges::copy_if(units, std::back_inserter(filled),
                       [](const Mean &unit) { return unit.count > 0; });
  const auto mean_of = [&](auto index) {
    Mean mean;
    for (std::size_t i = 0; i < filled.size(); ++i)
      mean.add(filled[index(i)]);
    return mean.value();
  };
  Estimate found{ .value = mean_of([](std::size_t i) { return i; }) };
  if (filled.size() < 2)
    return found;
  Random random(1);
  std::vector<double> means(kDraws);
  for (double &mean : means)
    mean = mean_of([&](std::size_t) {
      return static_cast<std::size_t>(random.uniform(0, static_cast<double>(filled.size())));
    });
  std::ranges::sort(means);
  const auto cut = static_cast<std::size_t>(kTail * kDraws);
  found.low = means[cut];
  found.high = means[kDraws - 1 - cut];
  return found;
}

std::string
text(const Estimate &estimate, int digits)
{
  return with_interval(figure(estimate.value, digits), estimate, 1, digits);
}

std::string
percent_text(const Estimate &share)
{
  return with_interval(percent(share.value), share, 100, 1);
}

} // namespace quality
