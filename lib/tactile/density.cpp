// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactile/density.h"

#include <algorithm>
#include <cmath>

namespace tactile {

double
DensityControl::follow(const SaliencyView &map, double floor, double density, Time time)
{
  if (density <= 0 || (last_time_ && time < *last_time_))
    reset();
  if (density <= 0)
    return floor;
  if (last_time_) {
    const double passed
        = std::chrono::duration<double>(std::min(time - *last_time_, kLongestShare)).count();
    raise_ = std::clamp(raise_ + kRate * ((felt_ ? 1 : 0) - density) * passed, 0.0,
                        std::log(kHighest));
  }
  last_time_ = time;
  const double raised = floor * std::exp(raise_) * (felt_ ? kHold : 1.0);
  const double now = std::max(floor, raised);
  felt_ = map.peak() > std::max(0.0, now);
  return now;
}

void
DensityControl::reset()
{
  *this = {};
}

} // namespace tactile
