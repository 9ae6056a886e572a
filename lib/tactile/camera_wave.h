// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactile/tactile_map.h"

#include <optional>

namespace tactile {

/// The camera's way since the last frame.
struct CameraWay
{
  double right = 0; ///< in widths of the picture
  double down = 0;  ///< in heights
  double ahead = 0; ///< logarithm of the picture's growth
};

/// A travelling camera as an effect of its own: a soft wave that runs over the grid in the
/// direction of travel, from the middle to both sides if that is ahead.
///
/// The wave and events never mix. It is weaker than any event, absent while one is felt, and
/// returns within about a second. A camera that shakes makes none. Not thread-safe.
class CameraWave
{
public:
  /// The largest level of the wave. Events have at least 0.3.
  static constexpr double kMost = 0.25;
  /// Speed of the picture, in its sides per second, up to which there is no wave, and from which on
  /// it has the largest level.
  static constexpr double kSlowest = 0.05;
  static constexpr double kFastest = 0.5;

  /// Adds the wave to the map of the frame at `time`, unless something is felt in it. A time that
  /// goes back, or a second later, begins anew.
  void follow(const CameraWay &way, Time time, TactileMap &map);

  /// The next frame follows no other: a cut, a seek.
  void reset()
  {
    *this = {};
  }

private:
  CameraWay speed_;   ///< a second, without shakes
  double cycles_ = 0; ///< of the wave so far
  double ease_ = 0;   ///< 0 while an event is felt, then toward 1
  std::optional<Time> last_time_;
};

} // namespace tactile
