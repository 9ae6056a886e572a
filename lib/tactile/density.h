// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactile/saliency_view.h"

#include <optional>

namespace tactile {

/// A controller of the floor that limits how much of the time is felt: the floor rises while maps
/// are felt and falls while they are not, so that the weaker events are dropped first.
///
/// With the share of time that may be felt d, the logarithm of the floor changes by kRate (1 − d) a
/// second of what is felt, and by −kRate d a second of silence, and stays between the mapping's
/// floor and kHighest times that. So over a time T at most d + ln(kHighest) / (kRate T) of it is
/// felt, unless events exceed kHold kHighest times the floor; what exceeds kHighest times the floor
/// always is. After a silence of ln(kHighest) / (kRate d) whatever exceeds the mapping's floor is
/// felt.
///
/// Depends on times, not on the number of maps. Not thread-safe.
class DensityControl
{
public:
  /// Per second: four seconds of events at d = 0.25 raise the floor 4.5 times.
  static constexpr double kRate = 0.5;
  /// Largest factor on the floor; of the tuned profile's that is ΔE 92.
  static constexpr double kHighest = 10;
  /// An event that is felt goes on until it is below this part of the floor, so that one that stays
  /// as strong as the floor does not flicker: at d = 0.25 it is felt for 0.6 s of 2.4 s.
  static constexpr double kHold = 0.8;
  /// A map counts for at most this time, so that a gap in the stream counts little.
  static constexpr Time kLongestShare = std::chrono::seconds(1);

  /// The floor for a map shown from `time` on, at least `floor`. `density` is d in (0, 1], or 0 for
  /// `floor` itself. A time that goes back resets.
  double follow(const SaliencyView &map, double floor, double density, Time time);

  /// Drops the past, for a seek.
  void reset();

private:
  double raise_ = 0;  ///< logarithm of the floor's factor, in [0, ln kHighest]
  bool felt_ = false; ///< the last map
  std::optional<Time> last_time_;
};

} // namespace tactile
