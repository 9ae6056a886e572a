// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/webvtt_cues.h"

#include "tracks/cue_builder.h"
#include "tracks/formats/webvtt.h"
#include "tracks/formats/webvtt_timing.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <utility>

namespace tactile {

namespace {

using std::chrono::milliseconds;

constexpr auto kLongestCue = static_cast<std::int32_t>(CueBuilder::kLongest / milliseconds(1));

std::int32_t
whole_ms(Time time)
{
  return static_cast<std::int32_t>(time / milliseconds(1));
}

bool
is_silent(const WebvttCue &cue)
{
  return std::ranges::all_of(cue.levels, [](int level) { return level == 0; });
}

WebvttCue
cue_of(std::int32_t start, std::int32_t end, const TactileMap &map)
{
  WebvttCue cue{ .start = start, .end = end, .levels = {}, .notes = {} };
  set_map(cue, map);
  return cue;
}

/// A part of a track between two times as cues, silent or not.
std::vector<WebvttCue>
stretches(const Track &track, std::int32_t from, std::int32_t to)
{
  std::vector<WebvttCue> cues;
  const auto &entries = track.entries();
  Time time = milliseconds(from);
  auto next = std::ranges::upper_bound(entries, time, {}, &Track::Entry::time);
  while (time < milliseconds(to)) {
    Time end = milliseconds(to);
    if (next != entries.end())
      end = std::min(end, next->time);
    if (time < track.end())
      end = std::min(end, track.end());
    cues.push_back(cue_of(whole_ms(time), whole_ms(end), track.at(time)));
    time = end;
    if (next != entries.end() && next->time <= time)
      ++next;
  }
  return cues;
}

/// Appends the cues of the track in a gap between the cues of the file.
void
fill_gap(std::vector<WebvttCue> &cues, const Track &track, std::int32_t from, std::int32_t to)
{
  for (WebvttCue &cue : stretches(track, from, to)) {
    if (is_silent(cue))
      continue;
    const std::int32_t end = cue.end;
    for (; cue.start < end; cue.start = cue.end) {
      cue.end = std::min(cue.start + kLongestCue, end);
      cues.push_back(cue);
    }
  }
}

/// `is_last`: it ends when the track does.
void
change_cue(std::vector<WebvttCue> &cues, const Track &track, const WebvttCue &cue, bool is_last)
{
  std::vector<WebvttCue> now = stretches(track, cue.start, cue.end);
  if (now.size() == 1 && now.front().has_map_of(cue)) {
    cues.push_back(cue);
    return;
  }
  // A silent cue stays where it gives the track its length, or has a comment.
  std::erase_if(now, [&](const WebvttCue &one) {
    return is_silent(one) && !(is_last && one.end == cue.end);
  });
  if (now.empty() && !cue.notes.empty())
    now.push_back(cue_of(cue.start, cue.end, TactileMap(track.rows(), track.columns())));
  if (!now.empty())
    now.front().notes = cue.notes;
  std::ranges::move(now, std::back_inserter(cues));
}

} // namespace

bool
is_webvtt_note(std::string_view note)
{
  return note.size() <= kLongestWebvttNote && note.find(kWebvttArrow) == std::string_view::npos
         && note.find("\n\n") == std::string_view::npos && !note.starts_with('\n')
         && !note.ends_with('\n') && note.find_first_of(std::string_view("\r\0", 2)) == note.npos
         && !webvtt_tactile_note(note.substr(0, note.find('\n')));
}

void
set_map(WebvttCue &cue, const TactileMap &map)
{
  cue.levels.clear();
  cue.levels.reserve(map.levels.size());
  for (const float level : map.levels)
    cue.levels.push_back(static_cast<std::uint8_t>(std::lround(level * kTextSteps)));
  // Nobody feels that of a silent map, and a track does not keep it.
  cue.frequency = is_silent(cue) ? 0 : static_cast<std::int32_t>(std::lround(map.frequency));
}

TactileMap
map_of(const WebvttCue &cue, const Grid &grid)
{
  TactileMap map(grid.rows, grid.columns);
  for (std::size_t i = 0; i < cue.levels.size() && i < map.levels.size(); i++)
    map.levels[i] = static_cast<float>(cue.levels[i]) / static_cast<float>(kTextSteps);
  map.frequency = static_cast<float>(cue.frequency);
  return map;
}

std::vector<WebvttCue>
cues_of(const Track &track, const std::vector<WebvttCue> &before)
{
  const Track rounded = at_resolution(track, kTextTick, kTextSteps);
  const std::int32_t length = whole_ms(rounded.end());
  std::vector<WebvttCue> cues;
  cues.reserve(before.size());
  std::int32_t end = 0;
  for (WebvttCue cue : before) {
    if (cue.start >= length)
      break;
    fill_gap(cues, rounded, end, cue.start);
    end = cue.end = std::min(cue.end, length);
    change_cue(cues, rounded, cue, end == length);
  }
  fill_gap(cues, rounded, end, length);
  end = cues.empty() ? 0 : cues.back().end;
  if (end < length)
    cues.push_back(cue_of(std::max(end, length - kLongestCue), length,
                          TactileMap(track.rows(), track.columns())));
  return cues;
}

} // namespace tactile
