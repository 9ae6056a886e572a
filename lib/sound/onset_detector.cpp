// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/onset_detector.h"

#include "sound/onset_weights.h"

#include <algorithm>
#include <numeric>

namespace sound {

bool
OnsetDetector::add(const BandPowers &powers)
{
  const bool rises = features_.add(powers);
  dead_ = std::max(dead_ - 1, 0);
  if (!rises || dead_ > 0)
    return false;
  const Features &features = features_.features();
  for (const Score &score : kScores)
    if (std::inner_product(features.begin(), features.end(), score.weights.begin(), score.offset)
        <= 0)
      return false;
  dead_ = kDeadHops;
  return true;
}

const Powers &
OnsetDetector::before() const
{
  return features_.before();
}

void
OnsetDetector::reset()
{
  features_.reset();
  dead_ = 0;
}

} // namespace sound
