// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactile/tactile_map.h"

#include <optional>
#include <vector>

namespace tactile {

/// Limits on the duration of a cue and on the break after it, per cell.
struct CueLimits
{
  Time max_duration{ 0 }; ///< 0: unlimited
  Time refractory{ 0 };   ///< 0: none
};

/// Limits for each cell how long a cue lasts and how soon the next one may follow. The user study
/// recommends this, as it "makes them more memorable and avoids excessive tactile events" (paper,
/// Section 6).
///
/// A cue is a stretch of time in which a cell's level is above 0. Breaks shorter than kShortestRest
/// do not end it, so a level that flickers is one cue.
///
/// A cue ends after `max_duration`. The cell is then silent until its input has been silent for
/// kShortestRest, or until a clearly stronger level comes. Stronger means at least kStrongerRatio
/// times the larger of kFaintLevel and the lowest level since the cue ended. For `refractory` after
/// the end of any cue, no cue starts in its cell; input that continues after that is felt from then
/// on.
///
/// The result depends on maps and times only, never on the number of frames. Not thread-safe.
class CueLimiter
{
public:
  /// A motor takes up to 180 ms to rise (paper, Eq. 1), so that a shorter break is not felt.
  static constexpr Time kShortestRest = std::chrono::milliseconds(100);
  /// Two to three times the just-noticeable difference in vibration amplitude, which is 20 to 33 %.
  static constexpr float kStrongerRatio = 1.5F;
  /// Below this level a motor hardly starts (0.5 V of 3 V: paper, Section 4).
  static constexpr float kFaintLevel = 0.2F;

  /// Sets the cells of `map`, shown from `time` on, that must be silent now to 0; leaves the others
  /// unchanged. A time that goes back, or another grid, resets. The same time may be passed again.
  void limit(TactileMap &map, Time time, const CueLimits &limits);

  /// Drops all cues, for a seek.
  void reset();

private:
  struct Cell
  {
    enum class State
    {
      at_rest,
      cue,
      spent, ///< the cue is over, its input still lasts
    };
    State state = State::at_rest;
    Time begin{ 0 };                  ///< of the cue
    std::optional<Time> end;          ///< of the last cue
    std::optional<Time> silent_since; ///< of the input; none while it is not silent
    float lowest = 0;                 ///< lowest level above 0 since the cue was spent

    bool is_felt(float level, Time time, const CueLimits &limits);
    bool begin_cue(Time time, const CueLimits &limits);
  };

  std::vector<Cell> cells_;
  int columns_ = 0;
  std::optional<Time> last_time_;
};

} // namespace tactile
