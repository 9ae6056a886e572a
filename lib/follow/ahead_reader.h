// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/cue_builder.h"
#include "tracks/draft.h"

#include <memory>
#include <optional>
#include <string>

namespace follow {

using visuotactile::Time;

/// A film that is read for its maps, from its beginning on until it is sent elsewhere. It neither
/// waits nor throws.
class MapSource
{
public:
  MapSource() = default;
  virtual ~MapSource() = default;
  MapSource(const MapSource &) = delete;
  MapSource &operator=(const MapSource &) = delete;

  /// The next map, in order of film time, if it has come. Between maps nothing is felt.
  virtual std::optional<tactile::Cue> take() = 0;
  /// All up to the film's end was taken.
  virtual bool is_ended() const = 0;
  /// Whether it can be sent elsewhere.
  virtual bool is_open() const = 0;
  /// Goes on at this film time, or more quickly at the next one from here on at which it can be
  /// read at once. Maps from elsewhere do not come any more.
  virtual void seek(Time to, bool exactly) = 0;
  /// Why nothing more comes; empty: it may.
  virtual std::string failure() = 0;
  /// Whether that is a fault of a track, rather than of its file.
  virtual bool is_faulty() const
  {
    return false;
  }
};

/// Reads a film's maps ahead of its position: first those that play next, then up to ten minutes
/// ahead, in the end the parts that were left out. CPU time limits the pace. Reads no clock; not
/// thread-safe.
class AheadReader
{
public:
  /// Less is urgent.
  static constexpr Time kNear = std::chrono::seconds(10);
  static constexpr Time kFar = std::chrono::minutes(10);
  /// CPU time a second: where it is urgent, and else.
  static constexpr double kUrgentShare = 0.85;
  static constexpr double kShare = 0.4;
  /// If the wanted part is nearer ahead of the source than this, it waits instead of seeking.
  static constexpr Time kSkip = std::chrono::seconds(5);
  /// A source that is behind the film by more, so long after it was sent somewhere, is too slow.
  static constexpr Time kLag = std::chrono::seconds(2);
  static constexpr Time kPatience = std::chrono::seconds(4);

  explicit AheadReader(std::unique_ptr<MapSource> source);

  /// Takes what has come. `position`: where the film is; `cpu`: CPU time of this process.
  void step(Time position, Time now, Time cpu);

  /// Grows in step(). None before the first map, which has the grid.
  const std::shared_ptr<tactile::Draft> &draft() const
  {
    return draft_;
  }
  /// Up to where all is known from a position on.
  Time known_until(Time position) const;
  /// All of the film is known.
  bool is_complete() const
  {
    return complete_;
  }
  /// Parts are left out, as the film plays faster than it can be read.
  bool is_too_slow() const
  {
    return too_slow_;
  }
  /// Where the film ends, as far as it was read.
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
  void seek(Time to, bool exactly, Time now);

  std::unique_ptr<MapSource> source_;
  std::shared_ptr<tactile::Draft> draft_;
  std::string failure_;
  Time begin_{ 0 };      ///< film time of the first map since the source was sent somewhere
  Time reach_{ 0 };      ///< all from begin_ to here is known
  bool exactly_ = true;  ///< else begin_ is where the first map is
  bool arrived_ = false; ///< that is known
  bool ended_ = false;
  bool complete_ = false;
  bool too_slow_ = false;
  Time end_{ 0 };
  std::optional<Time> sought_; ///< local time
  std::optional<Time> mark_;   ///< local time from which CPU time is counted
  Time cpu_mark_{ 0 };
};

} // namespace follow
