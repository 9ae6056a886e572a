// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/voicing.h"

#include "sound/dot.h"

#include <algorithm>
#include <cmath>

namespace sound {

namespace {

/// Added to the mean square of both parts: what is below −70 dB of full scale is not voiced.
constexpr float kFaintest = 1e-7F;

} // namespace

void
Voicing::add(double sample)
{
  for (Biquad &section : above_)
    sample = section.pass(sample);
  for (Biquad &section : below_)
    sample = section.pass(sample);
  if (++passed_ < kStep)
    return;
  passed_ = 0;
  if (end_ == kRoom) {
    std::copy(kept_.end() - kKept, kept_.end(), kept_.begin());
    end_ = kKept;
  }
  kept_[static_cast<std::size_t>(end_++)] = static_cast<float>(sample);
}

double
Voicing::take()
{
  for (Biquad &section : above_)
    section.settle();
  for (Biquad &section : below_)
    section.settle();
  const float *now = &kept_[static_cast<std::size_t>(end_ - kWindow)];
  const float faintest = kFaintest * kWindow;
  const float own = dot(now, now, kWindow) + faintest;
  float most = 0;
  float power = dot(now - kShortest, now - kShortest, kWindow);
  for (int lag = kShortest; lag <= kLongest; lag++) {
    const float alike = dot(now, now - lag, kWindow);
    most = std::max(most, alike / std::sqrt(own * (std::max(power, 0.0F) + faintest)));
    const float first = now[-lag - 1];
    const float last = now[kWindow - 1 - lag];
    power += first * first - last * last;
  }
  return std::min(static_cast<double>(most), 1.0);
}

void
Voicing::reset()
{
  *this = Voicing();
}

} // namespace sound
