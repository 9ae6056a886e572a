// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/events/strength.h"

#include <algorithm>
#include <cmath>

namespace saliency {

namespace {

constexpr double kQuantile = 0.95;
constexpr double kRate = 0.02; ///< of the quantile's logarithm, per frame at 30 fps
constexpr double kNothing = 1; ///< ΔE: less is no event, and says nothing of the film

} // namespace

double
Strength::follow(double energy, double elapsed)
{
  if (energy > kNothing)
    quantile_ *= std::exp(kRate * std::min(elapsed, 30.0)
                          * (energy > quantile_ ? kQuantile : kQuantile - 1));
  return energy / std::sqrt(quantile_ * kUsual);
}

} // namespace saliency
