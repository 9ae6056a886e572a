// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/sound_maps.h"

#include <algorithm>
#include <utility>

namespace fusion {

void
SoundMaps::hear(bool heard)
{
  const std::lock_guard lock(mutex_);
  heard_ = heard;
  maps_.clear();
}

bool
SoundMaps::is_heard() const
{
  const std::lock_guard lock(mutex_);
  return heard_;
}

void
SoundMaps::add(SoundMap map)
{
  const std::lock_guard lock(mutex_);
  while (!maps_.empty() && maps_.back().begin >= map.begin)
    maps_.pop_back();
  if (!maps_.empty())
    maps_.back().end = std::min(maps_.back().end, map.begin);
  if (map.end <= map.begin || tactile::is_silent(map.map))
    return;
  if (maps_.size() == kMost)
    maps_.pop_front();
  maps_.push_back(std::move(map));
}

void
SoundMaps::forget()
{
  const std::lock_guard lock(mutex_);
  maps_.clear();
}

void
SoundMaps::want(const void *reader, const Profile *profile)
{
  const std::lock_guard lock(mutex_);
  std::erase_if(readers_, [reader](const Reader &known) { return known.who == reader; });
  if (profile)
    readers_.push_back({ reader, profile });
}

const Profile *
SoundMaps::wanted() const
{
  const std::lock_guard lock(mutex_);
  return readers_.empty() ? nullptr : readers_.back().profile;
}

std::vector<SoundMap>
SoundMaps::between(Time begin, Time end) const
{
  const std::lock_guard lock(mutex_);
  const auto first = std::ranges::upper_bound(maps_, begin, {}, &SoundMap::end);
  const auto last = std::ranges::lower_bound(first, maps_.end(), end, {}, &SoundMap::begin);
  return { first, last };
}

} // namespace fusion
