// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/track.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace tactile {

namespace {

tl::unexpected<FormatError>
refused(std::string reason)
{
  return tl::unexpected(FormatError{ .place = {}, .reason = std::move(reason) });
}

} // namespace

Track::Track(int rows, int columns) : silent_(rows, columns), entries_{ { Time(0), silent_ } }
{
}

int
Track::rows() const
{
  return silent_.rows;
}

int
Track::columns() const
{
  return silent_.columns;
}

double
Track::rate() const
{
  return rate_;
}

void
Track::set_rate(double rate)
{
  rate_ = rate;
}

const std::vector<Track::Entry> &
Track::entries() const
{
  return entries_;
}

Time
Track::end() const
{
  return end_;
}

tl::expected<void, FormatError>
Track::append(Time time, const TactileMap &map)
{
  if (map.rows != rows() || map.columns != columns() || map.levels.size() != silent_.levels.size())
    return refused("expected a map of " + std::to_string(rows()) + " x " + std::to_string(columns())
                   + " levels");
  if (time < entries_.back().time || time < end_ || time > kMaxEnd)
    return refused("expected times that increase, up to 100 hours");
  if (map.frequency != 0 && is_silent(map))
    return append(time, silent_);
  if (time == entries_.back().time) {
    entries_.back().map = map;
    if (entries_.size() > 1 && std::prev(entries_.end(), 2)->map == map)
      entries_.pop_back();
  } else if (entries_.back().map != map) {
    if (entries_.size() >= kMaxEntries
        || (entries_.size() + 1) * silent_.levels.size() > kMaxLevels)
      return refused("expected at most " + std::to_string(kMaxEntries) + " changes and "
                     + std::to_string(kMaxLevels) + " levels");
    entries_.push_back({ time, map });
  }
  end_ = time;
  return {};
}

tl::expected<void, FormatError>
Track::set_end(Time end)
{
  if (end < Time(0) || end > kMaxEnd)
    return refused("expected an end from 0 to 100 hours");
  while (entries_.size() > 1 && entries_.back().time >= end)
    entries_.pop_back();
  if (end == Time(0))
    entries_.front().map = silent_;
  end_ = end;
  return {};
}

const TactileMap &
Track::at(Time time) const
{
  return time < Time(0) || time >= end_ ? silent_ : entries_[index_at(time)].map;
}

std::size_t
Track::index_at(Time time) const
{
  const auto after = std::ranges::upper_bound(entries_, time, {}, &Entry::time);
  return static_cast<std::size_t>(std::distance(entries_.begin(), after)) - 1;
}

bool
has_frequency(const Track &track)
{
  return std::ranges::any_of(track.entries(),
                             [](const Track::Entry &entry) { return entry.map.frequency > 0; });
}

Track
at_resolution(const Track &track, Time tick, int steps)
{
  Track result(track.rows(), track.columns());
  result.set_rate(track.rate());
  // Cannot fail: there are no more entries than before, and none is later.
  for (const Track::Entry &entry : track.entries()) {
    TactileMap map = entry.map;
    if (steps > 0) {
      for (float &level : map.levels)
        level = std::round(level * static_cast<float>(steps)) / static_cast<float>(steps);
      map.frequency = std::round(map.frequency);
    }
    (void)result.append(entry.time / tick * tick, map);
  }
  (void)result.set_end(track.end() / tick * tick);
  return result;
}

} // namespace tactile
