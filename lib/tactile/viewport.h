// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/saliency_view.h"
#include "tactile/time.h"

#include <optional>

namespace tactile {

/// The part of the picture that the grid's cells share among them, in shares of the picture's width
/// and height: 0 ≤ left, 0 < width, left + width ≤ 1, and the same from top to bottom. What lies
/// outside counts as if it lay on the border (see map_saliency).
struct Viewport
{
  double left = 0;
  double top = 0;
  double width = 1;
  double height = 1;

  bool operator==(const Viewport &) const = default;
};

/// A viewport that widens and narrows with what there is to be felt: film makers put what matters
/// in the middle, where a fixed mapping is felt "in the same location for a long period" (paper,
/// Section 6).
///
/// Along each axis it is the mean ± 2 σ of the saliency of the last seconds, in which a moment
/// counts the same however much was salient then. The whole picture is taken for a part of these
/// seconds: it is what the viewport begins with, what it goes back to after kSilence in which
/// nothing was salient, and why it never becomes narrower than 4 √(p / (1 + p) / 12) = 0.47 of the
/// picture, p = kPrior.
///
/// What counts is time, not the number of maps. Not thread-safe: one thread at a time.
class AdaptiveViewport
{
public:
  /// How long the past is remembered: its weight falls to 1/e in this time.
  static constexpr Time kMemory = std::chrono::seconds(8);
  /// What a picture that is salient everywhere weighs, where all that is remembered weighs at most
  /// 1: one event does not yet say where a film takes place.
  static constexpr double kPrior = 0.2;
  static constexpr Time kSilence = std::chrono::seconds(3);
  /// A map speaks for at most so much of the time before it.
  static constexpr Time kLongestShare = std::chrono::milliseconds(500);
  /// What a border moves at most in a second, as a share of the picture: unnoticed by itself.
  static constexpr double kSpeed = 0.25;

  /// The viewport for a map shown from `time` on, which the maps until then have led to. What
  /// counts of a map is what is felt of it: nothing if its maximum does not exceed `floor`, else
  /// the values above `threshold` × its maximum. Time that goes back resets.
  const Viewport &follow(const SaliencyView &map, double floor, double threshold, Time time);

  /// The whole picture at once, nothing remembered: a shot cut, or a jump in the film.
  void reset();

private:
  /// Where the saliency was along an axis, 0 to 1, weighted by how lately.
  struct Moments
  {
    double first = 0;  ///< Σ w x
    double second = 0; ///< Σ w x²
  };

  void remember(const SaliencyView &map, double cut, double decay, double share);

  double weight_ = 0; ///< Σ w, at most 1
  Moments horizontal_;
  Moments vertical_;
  Viewport viewport_;
  std::optional<Time> last_time_;
  Time last_salient_{ 0 };
};

} // namespace tactile
