// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace tactile {

/// Steps as points joined by straight lines, each step one millisecond long: the form of constant
/// levels in formats of interpolated curves (HJIF, .haptic, funscript).
class StepCurve
{
public:
  struct Point
  {
    std::int64_t position; ///< ms
    double value;
  };

  /// Sets `value` from `position` on. Positions must not decrease; the first is 0.
  void step(std::int64_t position, double value)
  {
    if (points_.empty()) {
      points_.push_back({ position, value });
      return;
    }
    if (value == points_.back().value)
      return;
    hold(position);
    if (points_.back().position > position) // two steps within two milliseconds
      position = points_.back().position;
    points_.push_back({ position + 1, value });
  }

  /// Ends the curve at `position` with value 0; it then has at least three points.
  void finish(std::int64_t position)
  {
    step(position, 0);
    if (points_.back().position < position)
      hold(position);
    if (points_.size() == 2 && position >= 2)
      points_.insert(points_.begin() + 1, { 1, points_.front().value });
    while (points_.size() < 3)
      points_.push_back({ points_.back().position + 1, points_.back().value });
  }

  const std::vector<Point> &points() const
  {
    return points_;
  }

  /// Holds the last value, if there is one, up to `position`.
  void hold(std::int64_t position)
  {
    if (!points_.empty() && points_.back().position < position)
      points_.push_back({ position, points_.back().value });
  }

private:
  std::vector<Point> points_;
};

/// The strongest cell's level over time, in milliseconds. With `steps` other than 0, it is the
/// nearest of that many steps, as a number of steps.
inline StepCurve
strongest_cell(const Track &track, int steps = 0)
{
  StepCurve curve;
  for (const Track::Entry &entry : track.entries()) {
    const auto level = static_cast<double>(std::ranges::max(entry.map.levels));
    curve.step(std::chrono::floor<std::chrono::milliseconds>(entry.time).count(),
               steps == 0 ? level : std::round(level * steps));
  }
  curve.finish(std::chrono::floor<std::chrono::milliseconds>(track.end()).count());
  return curve;
}

} // namespace tactile
