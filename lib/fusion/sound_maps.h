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
/// Several may hear different sounds of one film, such as its voices and its music. Nobody waits
/// for the other. Any thread.
class SoundMaps
{
public:
  /// Of each who hears, of which only those that are not silent are kept; the oldest ones go.
  static constexpr std::size_t kMost = 1024;

  /// `who` hears a sound, or does not any more: then what it heard is forgotten. Whether that
  /// changes is_heard().
  bool hear(const void *who, bool heard);
  /// By anybody.
  bool is_heard() const;

  /// Takes the place of all that `who`, who hears, knew from `map.begin` on: sound that comes
  /// again, as of another language, is not felt twice.
  void add(const void *who, SoundMap map);

  /// The film was sought in.
  void forget(const void *who);

  /// `reader` feels the sound by this profile from now on; nullptr: it does not.
  void want(const void *reader, const Profile *profile);
  /// What the last one wants who wants anything; nullptr if nobody does.
  const Profile *wanted() const;

  /// What is known of [begin, end), in order, without overlaps. Of several that sound at once, each
  /// cell has the largest level.
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

  /// nullptr if `who` does not hear.
  std::deque<SoundMap> *maps_of(const void *who);

  mutable std::mutex mutex_{};
  std::vector<Hearer> hearers_{};
  std::vector<Reader> readers_{};
};

} // namespace fusion
