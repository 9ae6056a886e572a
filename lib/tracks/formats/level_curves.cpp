// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/level_curves.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

namespace tactile {

namespace {

constexpr Time kRampStep = std::chrono::milliseconds(20);

tl::unexpected<FormatError>
wrong(std::string reason)
{
  return tl::unexpected(FormatError{ .place = {}, .reason = std::move(reason) });
}

/// The track with a frequency for each map, or the part of one, that is felt.
tl::expected<Track, FormatError>
tuned(const Track &track, const std::map<Time, float> &frequencies)
{
  Track result(track.rows(), track.columns());
  auto next = frequencies.begin();
  float frequency = 0;
  const auto &entries = track.entries();
  for (std::size_t i = 0; i < entries.size(); i++) {
    TactileMap map = entries[i].map;
    const Time end = i + 1 < entries.size() ? entries[i + 1].time : track.end();
    for (; next != frequencies.end() && next->first <= entries[i].time; ++next)
      frequency = next->second;
    map.frequency = frequency;
    auto appended = result.append(entries[i].time, map);
    for (; appended && next != frequencies.end() && next->first < end; ++next) {
      map.frequency = frequency = next->second;
      appended = result.append(next->first, map);
    }
    if (!appended)
      return tl::unexpected(std::move(appended.error()));
  }
  (void)result.set_end(track.end());
  return result;
}

} // namespace

LevelCurves::LevelCurves(double ticks_per_second, std::int64_t step_length)
    : ticks_per_second_(ticks_per_second), step_length_(step_length)
{
}

Time
LevelCurves::time_of(std::int64_t position) const
{
  return Time(std::llround(static_cast<double>(position) * 1e9 / ticks_per_second_));
}

void
LevelCurves::change(std::int64_t position, std::size_t channel, double level)
{
  changes_.push_back(
      { .time = time_of(position), .channel = channel, .curve = curves_, .level = level });
}

double
LevelCurves::latest() const
{
  return std::chrono::duration<double>(Track::kMaxEnd).count() * ticks_per_second_;
}

tl::expected<void, FormatError>
LevelCurves::add(std::size_t channel, std::span<const Point> points)
{
  if (points.empty())
    return {};
  if (points.front().position < 0 || static_cast<double>(points.back().position) > latest())
    return wrong("expected times from 0 to 100 hours");
  const double ramp_step
      = std::max(std::chrono::duration<double>(kRampStep).count() * ticks_per_second_, 1.0);
  std::int64_t end = points.back().position;
  change(points.front().position, channel, points.front().level);
  for (std::size_t i = 1; i < points.size(); i++) {
    const auto &[from, from_level] = points[i - 1];
    const auto &[to, to_level] = points[i];
    const auto length = static_cast<double>(to - from);
    if (from_level == to_level) {
      // holds
    } else if (to - from <= step_length_) {
      change(from, channel, to_level);
      if (i + 1 == points.size())
        end = from;
    } else {
      if (static_cast<double>(changes_.size()) + length / ramp_step > Track::kMaxEntries)
        return wrong("more changes than a track can have, " + std::to_string(Track::kMaxEntries));
      for (double at = 0; at < length; at += ramp_step) {
        const double middle = (at + std::min(at + ramp_step, length)) / 2 / length;
        change(from + std::llround(at), channel, from_level + (to_level - from_level) * middle);
      }
      change(to, channel, to_level);
    }
    if (changes_.size() >= Track::kMaxEntries)
      return wrong("more changes than a track can have, " + std::to_string(Track::kMaxEntries));
  }
  change(end, channel, 0);
  curves_++;
  return {};
}

bool
LevelCurves::has_other_frequency(Time begin, Time end, double frequency) const
{
  auto i = frequencies_.upper_bound(begin);
  if (i != frequencies_.begin())
    --i;
  return std::any_of(i, frequencies_.lower_bound(end), [&](const auto &each) {
    return each.second > 0 && std::abs(static_cast<double>(each.second) - frequency) >= 1;
  });
}

tl::expected<void, FormatError>
LevelCurves::set_frequency(const Point &from, const Point &to)
{
  const Time begin = time_of(from.position);
  const Time end = time_of(to.position);
  if (begin >= end)
    return {};
  const bool holds = from.level == to.level || to.position - from.position <= step_length_;
  const Time step = holds ? end - begin : kRampStep;
  std::vector<std::pair<const Time, float>> steps;
  for (Time at = begin; at < end; at += step) {
    const Time middle = (at + std::min(at + step, end)) / 2;
    const double part = holds ? 1 : std::chrono::duration<double>(middle - begin) / (end - begin);
    const double frequency = std::lerp(from.level, to.level, part);
    steps.emplace_back(at, frequency < 1 ? 0 : static_cast<float>(frequency));
    has_lost_frequency_
        = has_lost_frequency_ || has_other_frequency(at, std::min(at + step, end), frequency);
    if (++tuned_ > Track::kMaxEntries)
      return wrong("more changes than a track can have, " + std::to_string(Track::kMaxEntries));
  }
  const auto next = frequencies_.upper_bound(end);
  const float after = next == frequencies_.begin() ? 0 : std::prev(next)->second;
  const auto hint = frequencies_.erase(frequencies_.lower_bound(begin), next);
  for (const auto &each : steps)
    frequencies_.insert(hint, each);
  frequencies_.emplace_hint(hint, end, after);
  return {};
}

tl::expected<Track, FormatError>
LevelCurves::join(Track track, std::span<const std::vector<std::size_t>> cells)
{
  if (changes_.size() > kMostJoined / (cells.size() + track.rows() * track.columns()))
    return wrong("more changes, " + std::to_string(changes_.size())
                 + ", than are read of so many channels and cells, "
                 + std::to_string(cells.size() + track.rows() * track.columns()));
  std::ranges::stable_sort(changes_, {}, &Change::time);
  struct Active
  {
    std::size_t curve;
    double level;
  };
  std::vector<std::vector<Active>> active(cells.size());
  std::vector<double> sums(cells.size(), 0);
  TactileMap map(track.rows(), track.columns());
  for (std::size_t i = 0; i < changes_.size(); i++) {
    const Change &change = changes_[i];
    std::vector<Active> &curves = active[change.channel];
    std::erase_if(curves, [&](const Active &a) { return a.curve == change.curve; });
    if (change.level != 0)
      curves.push_back({ change.curve, change.level });
    if (curves.size() > kMostAtOnce)
      return wrong("expected at most " + std::to_string(kMostAtOnce) + " effects at a time");
    sums[change.channel] = 0;
    for (const Active &a : curves)
      sums[change.channel] += a.level;
    if (i + 1 < changes_.size() && changes_[i + 1].time == change.time)
      continue;
    std::ranges::fill(map.levels, 0.0F);
    for (std::size_t channel = 0; channel < cells.size(); channel++)
      for (const std::size_t cell : cells[channel])
        map.levels[cell]
            = std::min(map.levels[cell] + static_cast<float>(std::min(sums[channel], 1.0)), 1.0F);
    if (auto appended = track.append(change.time, map); !appended)
      return tl::unexpected(std::move(appended.error()));
  }
  if (auto ended = track.set_end(changes_.empty() ? Time(0) : changes_.back().time); !ended)
    return tl::unexpected(std::move(ended.error()));
  return frequencies_.empty() ? std::move(track) : tuned(track, frequencies_);
}

tl::expected<Track, FormatError>
LevelCurves::join()
{
  const std::vector<std::size_t> cell{ 0 };
  return join(Track(1, 1), { &cell, 1 });
}

} // namespace tactile
