// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/level_curves.h"

#include <algorithm>
#include <cmath>
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

} // namespace

LevelCurves::LevelCurves(double ticks_per_second, std::int64_t step_length)
    : ticks_per_second_(ticks_per_second), step_length_(step_length)
{
}

void
LevelCurves::change(std::int64_t position, std::size_t channel, double level)
{
  const double nanoseconds = static_cast<double>(position) * 1e9 / ticks_per_second_;
  changes_.push_back({ .time = Time(std::llround(nanoseconds)),
                       .channel = channel,
                       .curve = curves_,
                       .level = level });
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

tl::expected<Track, FormatError>
LevelCurves::join(Track track, std::span<const std::vector<std::size_t>> cells)
{
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
  return track;
}

} // namespace tactile
