// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/sound_maps.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <span>
#include <utility>

namespace fusion {

namespace {

/// Maps that may overlap → the same without overlaps, in order.
std::vector<SoundMap>
overlaid(std::span<const SoundMap> maps)
{
  std::set<Time> edges;
  for (const SoundMap &map : maps) {
    edges.insert(map.begin);
    edges.insert(map.end);
  }
  std::vector<SoundMap> result;
  for (auto edge = edges.begin(); edge != edges.end() && std::next(edge) != edges.end(); ++edge) {
    SoundMap piece{ *edge, *std::next(edge), {} };
    for (const SoundMap &map : maps)
      if (map.begin < piece.end && map.end > piece.begin) {
        if (piece.map.levels.empty())
          piece.map = map.map;
        else
          tactile::mix_into(piece.map, map.map, tactile::Mix::max);
      }
    if (!piece.map.levels.empty())
      result.push_back(std::move(piece));
  }
  return result;
}

} // namespace

std::deque<SoundMap> *
SoundMaps::maps_of(const void *who)
{
  const auto found = std::ranges::find(hearers_, who, &Hearer::who);
  return found == hearers_.end() ? nullptr : &found->maps;
}

bool
SoundMaps::hear(const void *who, bool heard)
{
  const std::lock_guard lock(mutex_);
  const bool was_heard = !hearers_.empty();
  if (!heard)
    std::erase_if(hearers_, [who](const Hearer &known) { return known.who == who; });
  else if (!maps_of(who))
    hearers_.push_back({ who, {} });
  return was_heard == hearers_.empty();
}

bool
SoundMaps::is_heard() const
{
  const std::lock_guard lock(mutex_);
  return !hearers_.empty();
}

void
SoundMaps::add(const void *who, SoundMap map)
{
  const std::lock_guard lock(mutex_);
  std::deque<SoundMap> *maps = maps_of(who);
  if (!maps)
    return;
  while (!maps->empty() && maps->back().begin >= map.begin)
    maps->pop_back();
  if (!maps->empty())
    maps->back().end = std::min(maps->back().end, map.begin);
  if (map.end <= map.begin || tactile::is_silent(map.map))
    return;
  if (maps->size() == kMost)
    maps->pop_front();
  maps->push_back(std::move(map));
}

void
SoundMaps::forget(const void *who)
{
  const std::lock_guard lock(mutex_);
  if (std::deque<SoundMap> *maps = maps_of(who))
    maps->clear();
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
  std::vector<SoundMap> known;
  for (const auto &[who, maps] : hearers_) {
    const auto first = std::ranges::upper_bound(maps, begin, {}, &SoundMap::end);
    const auto last = std::ranges::lower_bound(first, maps.end(), end, {}, &SoundMap::begin);
    known.insert(known.end(), first, last);
  }
  return hearers_.size() > 1 ? overlaid(known) : known;
}

} // namespace fusion
