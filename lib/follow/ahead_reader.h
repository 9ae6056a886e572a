// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/cue_builder.h"
#include "tracks/draft.h"

#include <memory>
#include <optional>
#include <string>

namespace follow {

using visuotactile::Time;

/// Reads the maps of a film, from its beginning or from the target of seek(). It neither waits nor
/// throws.
class MapSource
{
public:
  MapSource() = default;
  virtual ~MapSource() = default;
  MapSource(const MapSource &) = delete;
  MapSource &operator=(const MapSource &) = delete;

  /// The next map, in order of film time, if it is ready. Time between maps is silent.
  virtual std::optional<tactile::Cue> take() = 0;
  /// Whether all maps up to the film's end were taken.
  virtual bool is_ended() const = 0;
  /// Whether seek() is possible.
  virtual bool is_open() const = 0;
  /// Continues at this film time or, unless `exactly`, at the next time that can be read at once.
  /// Drops all other maps.
  virtual void seek(Time to, bool exactly) = 0;
  /// The reason for which no more maps come; empty: they may.
  virtual std::string failure() = 0;
  /// Whether that is a fault of a track, rather than of its file.
  virtual bool is_faulty() const
  {
    return false;
  }
};

/// Reads a film's maps ahead of its position: first those that play next, then up to ten minutes
/// ahead, at the end the skipped parts. CPU time limits the pace. Reads no clock; not thread-safe.
class AheadReader
{
public:
  /// Reading is urgent if less than this is known ahead of the position.
  static constexpr Time kNear = std::chrono::seconds(10);
  static constexpr Time kFar = std::chrono::minutes(10);
  /// CPU time a second, if reading is urgent and otherwise.
  static constexpr double kUrgentShare = 0.85;
  static constexpr double kShare = 0.4;
  /// If the wanted part is nearer ahead of the source than this, it waits instead of seeking.
  static constexpr Time kSkip = std::chrono::seconds(5);
  /// A source that is farther behind the film for so long is too slow.
  static constexpr Time kLag = std::chrono::seconds(2);
  static constexpr Time kPatience = std::chrono::seconds(2);

  explicit AheadReader(std::unique_ptr<MapSource> source);

  /// Takes the maps that are ready. `position`: of the film; `cpu`: CPU time of this process.
  void step(Time position, Time now, Time cpu);

  /// Grows in step(). None before the first map, which has the grid.
  const std::shared_ptr<tactile::Draft> &draft() const
  {
    return draft_;
  }
  /// End of the known part from a position on.
  Time known_until(Time position) const;
  /// Whether so much is known ahead of a position that nothing is read.
  bool is_far_ahead(Time position) const;
  /// Whether all of the film is known.
  bool is_complete() const
  {
    return complete_;
  }
  /// Whether parts are skipped, as the film plays faster than it can be read.
  bool is_too_slow() const
  {
    return too_slow_;
  }
  /// End of the film, as far as it was read.
  Time end() const
  {
    return end_;
  }
  /// Why nothing more will be known; empty: it may.
  const std::string &failure() const
  {
    return failure_;
  }
  /// As MapSource::is_faulty().
  bool is_faulty() const
  {
    return source_->is_faulty();
  }

private:
  bool may_read(Time position, Time now, Time cpu);
  void add(const tactile::Cue &cue);
  void set(Time begin, Time end, const tactile::TactileMap &map);
  void choose(Time position, Time now);
  void seek(Time to, bool exactly);

  std::unique_ptr<MapSource> source_;
  std::shared_ptr<tactile::Draft> draft_;
  std::string failure_;
  Time begin_{ 0 };      ///< film time of the first map since the last seek
  Time reach_{ 0 };      ///< all from begin_ to here is known
  bool exactly_ = true;  ///< else begin_ is where the first map is
  bool arrived_ = false; ///< begin_ is known
  bool ended_ = false;
  bool complete_ = false;
  bool too_slow_ = false;
  Time end_{ 0 };
  std::optional<Time> late_since_; ///< local time
  std::optional<Time> mark_;       ///< local time from which CPU time is counted
  Time cpu_mark_{ 0 };
};

} // namespace follow
