// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/tactile_map.h"
#include "tactile/time.h"

#include <optional>
#include <vector>

namespace tactile {

/// How long a cell may be felt without a break and how long that break is at least.
struct CueLimits
{
  Time max_duration{ 0 }; ///< 0: unlimited
  Time refractory{ 0 };   ///< 0: none
};

/// Limits, for each cell on its own, how long a cue lasts and how soon the next one may follow: the
/// user study asks for it, as it "makes them more memorable and avoids excessive tactile events"
/// (paper, Section 6).
///
/// A cue is a stretch in which a cell's level is above 0. Breaks of less than kShortestRest belong
/// to it: a level that flickers is one cue.
///
/// A cue that has lasted `max_duration` is over. The cell is then silent until its input has been
/// silent for kShortestRest, or until something clearly stronger comes: a level of at least
/// kStrongerRatio times the lowest since the cue was over, or times kFaintLevel if that is more.
/// For `refractory` after the end of a cue, whatever ended it, no cue starts in its cell; what goes
/// on after that is felt from then on.
///
/// A pure function of the maps and their times: what counts is time, never the number of frames.
/// Not thread-safe: one thread at a time.
class CueLimiter
{
public:
  /// A motor takes up to 150 ms to follow (paper, Section 4), so a shorter break is not felt as an
  /// end.
  static constexpr Time kShortestRest = std::chrono::milliseconds(100);
  /// Two to three times the difference in the amplitude of a vibration that people just notice,
  /// which is a fifth to a third.
  static constexpr float kStrongerRatio = 1.5F;
  /// Below this a motor hardly starts (0.5 V of 3 V: paper, Section 4).
  static constexpr float kFaintLevel = 0.2F;

  /// Silences the cells of `map`, which is shown from `time` on, that are not to be felt now;
  /// leaves the others as they are. Time that goes back, or another grid, resets. The same time
  /// twice is fine.
  void limit(TactileMap &map, Time time, const CueLimits &limits);

  /// Forgets all cues, as after a jump in the film.
  void reset();

private:
  struct Cell
  {
    enum class State
    {
      at_rest,
      cue,
      spent, ///< the cue is over, its event is not
    };
    State state = State::at_rest;
    Time begin{ 0 };                  ///< of the cue
    std::optional<Time> end;          ///< of the last cue
    std::optional<Time> silent_since; ///< of the input; none: it is not silent
    float lowest = 0;                 ///< level above 0 since the cue was spent

    bool is_felt(float level, Time time, const CueLimits &limits);
    bool begin_cue(Time time, const CueLimits &limits);
  };

  std::vector<Cell> cells_;
  int columns_ = 0;
  std::optional<Time> last_time_;
};

} // namespace tactile
