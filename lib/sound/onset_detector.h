// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sound/onset_features.h"

namespace sound {

/// Finds impacts of every kind in band powers, explosions and shots among them, and separates them
/// from voices, notes and drums: one hidden layer over OnsetFeatures (onset_weights.h), learned
/// from real sounds by tests/sound/train.py.
class OnsetDetector
{
public:
  /// No second onset within this time.
  static constexpr int kDeadHops = 30;

  /// `looks_ahead`: knows 80 ms later, and better.
  explicit OnsetDetector(bool looks_ahead);

  /// Takes the next hop. Returns whether an impact with more than the least score, plus `more`,
  /// begins in the hop ahead() before it.
  bool add(const BandPowers &powers, float more);

  int ahead() const
  {
    return features_.ahead();
  }

  /// Powers in the 50 ms before the hop of the last add(), the largest of each band.
  const Powers &before() const
  {
    return features_.before();
  }

  void reset();

private:
  bool looks_ahead() const
  {
    return ahead() > OnsetFeatures::kAhead;
  }

  float score() const;

  OnsetFeatures features_;
  std::array<float, 3> scores_{}; ///< of the newest hops: an impact in one of them alone is chance
  int dead_ = 0;                  ///< hops until the next onset may come
};

} // namespace sound
