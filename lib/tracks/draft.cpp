// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/draft.h"

#include <algorithm>
#include <iterator>

namespace tactile {

Draft::Draft(int rows, int columns) : silent_(rows, columns), maps_{ { Time(0), std::nullopt } }
{
}

Draft::Draft(const Track &track) : Draft(track.rows(), track.columns())
{
  for (const Track::Entry &entry : track.entries())
    maps_[entry.time] = entry.map;
  maps_[track.end()] = silent_;
}

int
Draft::rows() const
{
  return silent_.rows;
}

int
Draft::columns() const
{
  return silent_.columns;
}

std::map<Time, Draft::Map>::const_iterator
Draft::find(Time time) const
{
  return std::prev(maps_.upper_bound(std::max(time, Time(0))));
}

const TactileMap *
Draft::at(Time time) const
{
  const Map &map = find(time)->second;
  return map ? &*map : nullptr;
}

Time
Draft::until(Time time) const
{
  const auto next = std::next(find(time));
  return next == maps_.end() ? Time::max() : next->first;
}

Time
Draft::known_until(Time time) const
{
  const auto first = find(time);
  const auto unknown
      = std::find_if(first, maps_.end(), [](const auto &one) { return !one.second; });
  return unknown == maps_.end() ? Time::max() : std::max(unknown->first, time);
}

tl::expected<void, FormatError>
Draft::set(Time begin, Time end, const TactileMap &map)
{
  const auto refused = [](const char *why) {
    return tl::unexpected(FormatError{ .place = {}, .reason = why });
  };
  if (map.rows != silent_.rows || map.columns != silent_.columns
      || map.levels.size() != silent_.levels.size())
    return refused("the map has another grid than the draft");
  if (begin < Time(0) || end > Track::kMaxEnd)
    return refused("expected times from 0 to 100 hours");
  const std::size_t most = std::min(Track::kMaxEntries, Track::kMaxLevels / silent_.levels.size());
  if (maps_.size() + 2 > most)
    return refused("the draft is full");
  if (begin >= end)
    return {};
  Map after = find(end)->second;
  maps_.erase(maps_.lower_bound(begin), maps_.lower_bound(end));
  maps_.try_emplace(end, std::move(after));
  const auto set = maps_.insert_or_assign(begin, map).first;
  // Neighbors differ.
  if (const auto next = std::next(set); next->second == set->second)
    maps_.erase(next);
  if (set != maps_.begin() && std::prev(set)->second == set->second)
    maps_.erase(set);
  return {};
}

Track
Draft::track(Time end, double rate) const
{
  Track track(rows(), columns());
  track.set_rate(rate);
  // Never fuller than a track can be.
  for (const auto &[time, map] : maps_)
    (void)track.append(time, map.value_or(silent_));
  (void)track.set_end(std::clamp(end, Time(0), Track::kMaxEnd));
  return track;
}

} // namespace tactile
