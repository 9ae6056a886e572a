// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactile/saliency_view.h"

#include <optional>

namespace tactile {

/// The part of the picture that the grid covers, in shares of the picture's width and height: 0 ≤
/// left, 0 < width, left + width ≤ 1, and the same for top and height. Samples outside count at its
/// border (see map_saliency()).
struct Viewport
{
  double left = 0;
  double top = 0;
  double width = 1;
  double height = 1;

  bool operator==(const Viewport &) const = default;
};

/// A viewport that adapts to where saliency is. Film makers put what matters in the middle, where a
/// fixed mapping is felt "in the same location for a long period" (paper, Section 6).
///
/// Along each axis it is the mean ± 2 σ of the saliency of the last seconds; each moment counts the
/// same, however much was salient. A uniform prior over the whole picture is mixed in. The viewport
/// starts with the whole picture and returns to it after kSilence without saliency. The prior keeps
/// it from becoming narrower than 4 √(p / (1 + p) / 12) = 0.47 of the picture, p = kPrior.
///
/// Depends on times, not on the number of maps. Not thread-safe.
class AdaptiveViewport
{
public:
  /// Time constant of the exponential decay of past maps.
  static constexpr Time kMemory = std::chrono::seconds(8);
  /// Weight of the uniform prior, relative to a maximum of 1 for all past maps: a single event does
  /// not yet show where a film takes place.
  static constexpr double kPrior = 0.2;
  static constexpr Time kSilence = std::chrono::seconds(3);
  /// Longest time before a map that the map is weighted by.
  static constexpr Time kLongestShare = std::chrono::milliseconds(500);
  /// Largest speed of a border, as a share of the picture per second: too slow to be noticed.
  static constexpr double kSpeed = 0.25;

  /// Updates the viewport for a map shown from `time` on. Only what is most salient counts: nothing
  /// if the maximum does not exceed `floor`, else the values above `threshold` × the maximum. A
  /// time that goes back resets.
  const Viewport &follow(const SaliencyView &map, double floor, double threshold, Time time);

  /// Returns to the whole picture at once and drops the past, for a shot cut or a seek.
  void reset();

private:
  /// Weighted moments of the positions along an axis, in [0, 1].
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
