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

/// What is felt of a film's sound in [begin, end), in running time.
struct SoundMap
{
  Time begin{ 0 };
  Time end{ 0 };
  tactile::TactileMap map;
};

/// Where the sound of a pipeline meets its picture: who hears the film writes, who plays it reads.
/// Nobody waits for the other. Any thread.
class SoundMaps
{
public:
  /// Of which only those that are not silent are kept; the oldest ones go.
  static constexpr std::size_t kMost = 1024;

  /// Somebody hears the sound, or nobody does any more: then all is forgotten.
  void hear(bool heard);
  bool is_heard() const;

  /// Takes the place of all that was known from `map.begin` on: sound that comes again, as of
  /// another language, is not felt twice.
  void add(SoundMap map);

  /// The film was sought in.
  void forget();

  /// `reader` feels the sound by this profile from now on; nullptr: it does not.
  void want(const void *reader, const Profile *profile);
  /// What the last one wants who wants anything; nullptr if nobody does.
  const Profile *wanted() const;

  /// What is known of [begin, end), in order.
  std::vector<SoundMap> between(Time begin, Time end) const;

private:
  struct Reader
  {
    const void *who;
    const Profile *profile;
  };

  mutable std::mutex mutex_{};
  bool heard_ = false;
  std::deque<SoundMap> maps_{}; ///< in order, without overlaps
  std::vector<Reader> readers_{};
};

} // namespace fusion
