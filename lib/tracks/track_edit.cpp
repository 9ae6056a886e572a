// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/track_edit.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <utility>

namespace tactile {

namespace {

constexpr Time kLimitStep = std::chrono::milliseconds(10);

using Edited = tl::expected<Track, FormatError>;

Track
empty_like(const Track &track)
{
  Track result(track.rows(), track.columns());
  result.set_rate(track.rate());
  return result;
}

/// A track that is built map by map and may become too large.
class LimitedTrack
{
public:
  explicit LimitedTrack(Track empty) : track_(std::move(empty))
  {
  }

  void append(Time time, const TactileMap &map)
  {
    if (fits_)
      fits_ = track_.append(time, map);
  }

  Edited finish(Time end)
  {
    if (fits_)
      fits_ = track_.set_end(end);
    if (!fits_)
      return tl::unexpected(fits_.error());
    return std::move(track_);
  }

  /// The track, for times that a track already has and that therefore fit.
  Track finish_fitting(Time end)
  {
    Edited finished = finish(end);
    assert(finished);
    return std::move(*finished);
  }

private:
  Track track_;
  tl::expected<void, FormatError> fits_;
};

/// The track with `change` applied to each map.
Track
with_maps(const Track &track, const std::function<void(TactileMap &)> &change)
{
  LimitedTrack result(empty_like(track));
  for (const Track::Entry &entry : track.entries()) {
    TactileMap map = entry.map;
    change(map);
    result.append(entry.time, map);
  }
  return result.finish_fitting(track.end());
}

Time
end_of(const Track &track, std::size_t entry)
{
  return entry + 1 < track.entries().size() ? track.entries()[entry + 1].time : track.end();
}

/// The track without events for which `is_pruned(duration, highest level)` is true.
Track
without_events(const Track &track, const std::function<bool(Time, float)> &is_pruned)
{
  const auto &entries = track.entries();
  std::vector<TactileMap> maps;
  maps.reserve(entries.size());
  for (const Track::Entry &entry : entries)
    maps.push_back(entry.map);
  const std::size_t cells = entries.front().map.levels.size();
  for (std::size_t cell = 0; cell < cells; cell++)
    for (std::size_t first = 0; first < entries.size();) {
      if (!(entries[first].map.levels[cell] > 0)) {
        first++;
        continue;
      }
      std::size_t last = first; // one past the event
      float strongest = 0;
      for (; last < entries.size() && entries[last].map.levels[cell] > 0; last++)
        strongest = std::max(strongest, entries[last].map.levels[cell]);
      if (is_pruned(end_of(track, last - 1) - entries[first].time, strongest))
        for (std::size_t i = first; i < last; i++)
          maps[i].levels[cell] = 0;
      first = last;
    }
  LimitedTrack result(empty_like(track));
  for (std::size_t i = 0; i < entries.size(); i++)
    result.append(entries[i].time, maps[i]);
  return result.finish_fitting(track.end());
}

/// All times at which either track changes, up to the later end.
std::vector<Time>
change_times(const Track &a, const Track &b)
{
  std::vector<Time> times;
  for (const Track *track : { &a, &b }) {
    for (const Track::Entry &entry : track->entries())
      times.push_back(entry.time);
    times.push_back(track->end());
  }
  std::ranges::sort(times);
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

bool
have_same_grid(const Track &a, const Track &b)
{
  return a.rows() == b.rows() && a.columns() == b.columns();
}

tl::unexpected<FormatError>
grids_differ()
{
  return tl::unexpected(
      FormatError{ .place = {}, .reason = "the grids differ; resample one of them first" });
}

} // namespace

Track
prune_short(const Track &track, Time shortest)
{
  return without_events(track, [&](Time length, float) { return length < shortest; });
}

Track
prune_weak(const Track &track, float weakest)
{
  return without_events(track, [&](Time, float strongest) { return strongest < weakest; });
}

Track
merge_equal(const Track &track, float tolerance)
{
  LimitedTrack result(empty_like(track));
  const TactileMap *last = nullptr; // of the result
  const auto is_equal = [&](float a, float b) {
    // Zero and nonzero levels never count as equal.
    return std::abs(a - b) <= tolerance && (a > 0) == (b > 0);
  };
  for (const Track::Entry &entry : track.entries()) {
    if (last && entry.map.frequency == last->frequency
        && std::ranges::equal(entry.map.levels, last->levels, is_equal))
      continue;
    result.append(entry.time, entry.map);
    last = &entry.map;
  }
  return result.finish_fitting(track.end());
}

Edited
limit_events(const Track &track, const CueLimits &limits)
{
  CueLimiter limiter;
  LimitedTrack result(empty_like(track));
  const auto &entries = track.entries();
  for (std::size_t i = 0; i < entries.size(); i++) {
    const Time end = end_of(track, i);
    for (Time time = entries[i].time; time < end; time += kLimitStep) {
      TactileMap map = entries[i].map;
      limiter.limit(map, time, limits);
      result.append(time, map);
    }
  }
  return result.finish(track.end());
}

Edited
shift(const Track &track, Time offset)
{
  LimitedTrack result(empty_like(track));
  const auto &entries = track.entries();
  for (std::size_t i = 0; i < entries.size(); i++)
    if (end_of(track, i) + offset > Time(0))
      result.append(std::max(entries[i].time + offset, Time(0)), entries[i].map);
  return result.finish(std::max(track.end() + offset, Time(0)));
}

Track
scale(const Track &track, float factor)
{
  return with_maps(track, [&](TactileMap &map) {
    for (float &level : map.levels)
      level = std::min(level * factor, 1.0F);
  });
}

Edited
clip(const Track &track, Time begin, Time end)
{
  Track result = track;
  (void)result.set_end(std::clamp(end, Time(0), track.end()));
  return shift(result, -begin);
}

Edited
silence(const Track &track, Time begin, Time end)
{
  LimitedTrack result(empty_like(track));
  const TactileMap silent(track.rows(), track.columns());
  const auto &entries = track.entries();
  for (std::size_t i = 0; i < entries.size(); i++) {
    const Time from = entries[i].time;
    const Time to = end_of(track, i);
    if (from < begin || from >= end)
      result.append(from, entries[i].map);
    if (std::max(from, begin) < std::min(to, end)) {
      result.append(std::max(from, begin), silent);
      if (end < to)
        result.append(end, entries[i].map);
    }
  }
  return result.finish(track.end());
}

Track
tune(const Track &track, float frequency)
{
  return with_maps(track, [&](TactileMap &map) { map.frequency = frequency; });
}

Track
mask(const Track &track, const std::vector<int> &cells)
{
  return with_maps(track, [&](TactileMap &map) {
    for (const int cell : cells)
      if (cell >= 0 && static_cast<std::size_t>(cell) < map.levels.size())
        map.levels[static_cast<std::size_t>(cell)] = 0;
  });
}

Track
quantize(const Track &track, int steps)
{
  return at_resolution(track, Time(1), steps);
}

Edited
resample(const Track &track, int rows, int columns)
{
  Track empty(rows, columns);
  empty.set_rate(track.rate());
  LimitedTrack result(empty);
  for (const Track::Entry &entry : track.entries())
    result.append(entry.time, resample(entry.map, empty.rows(), empty.columns()));
  return result.finish(track.end());
}

Edited
overlay(const Track &track, const Track &over, Mix mix)
{
  LimitedTrack result(empty_like(track));
  for (const Time time : change_times(track, over)) {
    TactileMap map = track.at(time);
    mix_into(map, over.at(time), mix);
    result.append(time, map);
  }
  return result.finish(std::max(track.end(), over.end()));
}

Edited
replace(const Track &track, const Track &by, Time begin, Time end, const std::vector<int> &cells)
{
  if (!have_same_grid(track, by))
    return grids_differ();
  std::vector<Time> times = change_times(track, by);
  times.insert(times.end(), { begin, end });
  std::ranges::sort(times);
  const Time last = std::max(track.end(), std::min(end, by.end()));
  LimitedTrack result(empty_like(track));
  for (const Time time : times) {
    if (time < Time(0) || time > last)
      continue;
    TactileMap map = track.at(time);
    if (time >= begin && time < end) {
      const TactileMap &other = by.at(time);
      if (cells.empty())
        map = other;
      for (const int cell : cells)
        if (cell >= 0 && static_cast<std::size_t>(cell) < map.levels.size())
          map.levels[static_cast<std::size_t>(cell)] = other.levels[static_cast<std::size_t>(cell)];
    }
    result.append(time, map);
  }
  return result.finish(last);
}

bool
is_same_frequency(const TactileMap &a, const TactileMap &b, float tolerance)
{
  const float most = tolerance > 0 ? 0.5F : 0; // Hz, as some formats have whole numbers
  return std::abs(a.frequency - b.frequency) <= most;
}

tl::expected<std::vector<Difference>, FormatError>
diff(const Track &before, const Track &after, float tolerance)
{
  if (!have_same_grid(before, after))
    return grids_differ();
  std::vector<Difference> differences;
  const std::vector<Time> times = change_times(before, after);
  for (std::size_t i = 0; i + 1 < times.size(); i++) {
    const TactileMap &a = before.at(times[i]);
    const TactileMap &b = after.at(times[i]);
    const bool same = is_same_frequency(a, b, tolerance)
                      && std::ranges::equal(a.levels, b.levels, [&](float x, float y) {
                           return std::abs(x - y) <= tolerance;
                         });
    if (same)
      continue;
    Difference *last = differences.empty() ? nullptr : &differences.back();
    if (last && last->end == times[i] && last->before == a && last->after == b)
      last->end = times[i + 1];
    else
      differences.push_back({ times[i], times[i + 1], a, b });
  }
  return differences;
}

} // namespace tactile
