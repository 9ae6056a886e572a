// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "estimate.h"
#include "films.h"
#include "tactile/tactile_map.h"

#include <map>
#include <optional>
#include <vector>

namespace quality {

/// How well maps follow films (docs/design/quality.md). An event is an onset, that is a ball that
/// appears or starts to move, or its movement; a ball that is there in the first frame is none. A
/// cell is a ball's if the square around the ball touches it.
struct Scores
{
  Mean strongest; ///< (a) strongest cell is a ball's: frames within 0.5 s of an event
  Mean energy;    ///< (b) the map's energy in cells of balls: the same frames, if not silent
  Mean silent;    ///< (c) silent: frames without an event for 2.2 s
  Mean delay;     ///< (d) frames from an onset to the first level above zero in the ball's cells
  Mean prompt;    ///< onsets with a level in their first frame
  Mean pair;      ///< (e) both balls are felt: frames within 0.5 s of two balls' common onset
  Mean active;    ///< not silent: all frames
  Mean camera;    ///< the camera counts as moving: all frames
  Mean cells;     ///< cells above zero: all frames
  Mean found;     ///< felt within 1/3 s in the ball's cells: onsets that could be seen
  Mean right;     ///< strongest cell is a ball's: frames not silent within 0.5 s of such an onset

  /// Adds those of other films.
  void add(const Scores &other);
};

/// Scores one film.
class Judge
{
public:
  Judge(Scores &scores, cv::Size size) : scores_(scores), size_(size)
  {
  }

  void frame(const LabeledFilm &film, Time time, const std::vector<tactile::Ball> &balls,
             const tactile::TactileMap &map);

  /// After the last frame.
  void finish();

private:
  /// The current onset.
  struct Onset
  {
    Time time;
    double frames = 0; ///< since
    bool felt = false;
    bool found = false;
    double right = 0;
    double active = 0;
  };

  void follow_onset(const LabeledFilm &film, Time time, bool touched, bool strongest, bool active);
  void finish_onset(const LabeledFilm &film);

  Scores &scores_;
  cv::Size size_;
  std::map<int, Time> onsets_; ///< of the balls in the last frame
  std::optional<Onset> onset_;
  const LabeledFilm *film_ = nullptr;
  std::optional<Time> last_event_;
  std::optional<Time> last_pair_; ///< common onset of two balls
  bool first_ = true;
};

} // namespace quality
