// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "fusion/profile.h"
#include "nanoseconds.h"
#include "tactile/tactile_map.h"

#include <cstddef>
#include <deque>
#include <mutex>
#include <vector>

namespace fusion {

using visuotactile::Time;

/// The map of a film's sound in [begin, end), in running time.
struct SoundMap
{
  Time begin{ 0 };
  Time end{ 0 };
  tactile::TactileMap map;
};

/// The meeting place of sound and picture in a pipeline: soundtactile (a hearer) writes, the sink
/// (a reader) reads. Several hearers may analyze different sounds of one film, such as its voices
/// and its music. Neither side waits. Any thread.
class SoundMaps
{
public:
  /// Limit of maps of each hearer. Silent maps are not stored; the oldest ones are dropped.
  static constexpr std::size_t kMost = 1024;

  /// Adds the hearer `who`, or removes it and its maps. Returns whether that changes is_heard().
  bool hear(const void *who, bool heard);
  /// Whether there is a hearer.
  bool is_heard() const;

  /// Replaces all maps of the hearer `who` from `map.begin` on: sound that comes again, as of
  /// another language, is not felt twice.
  void add(const void *who, SoundMap map);

  /// Drops the maps of a hearer, as after a seek.
  void forget(const void *who);

  /// Sets the profile of a reader; nullptr: it takes no sound.
  void want(const void *reader, const Profile *profile);
  /// Profile of the most recent reader that has one; nullptr: none has.
  const Profile *wanted() const;

  /// The known maps of [begin, end), in order, without overlaps. If several overlap, each cell has
  /// the largest level.
  std::vector<SoundMap> between(Time begin, Time end) const;

private:
  struct Reader
  {
    const void *who;
    const Profile *profile;
  };

  struct Hearer
  {
    const void *who;
    std::deque<SoundMap> maps; ///< in order, without overlaps
  };

  /// nullptr if `who` is no hearer.
  std::deque<SoundMap> *maps_of(const void *who);

  mutable std::mutex mutex_{};
  std::vector<Hearer> hearers_{};
  std::vector<Reader> readers_{};
};

} // namespace fusion
