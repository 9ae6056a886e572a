// SPDX-License-Identifier: LGPL-2.1-or-later
#include "desk/document.h"

#include "tracks/formats/webvtt.h"

#include <glib.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace desk {

namespace {

using Applied = tl::expected<void, std::string>;

tl::unexpected<std::string>
refused(std::string reason)
{
  return tl::unexpected(std::move(reason));
}

std::string
times_of(const Cue &cue)
{
  return std::to_string(cue.start) + " to " + std::to_string(cue.end) + " ms";
}

template <typename Values>
auto
place(Values &values, std::size_t index)
{
  return values.begin() + static_cast<std::ptrdiff_t>(index);
}

/// Applies a splice that fits, and returns the one that takes it back.
Splice
spliced(std::vector<Cue> &cues, std::size_t at, std::size_t remove, std::vector<Cue> insert)
{
  Splice back{ .at = at, .remove = insert.size(), .insert = {} };
  const auto first = place(cues, at);
  const auto last = place(cues, at + remove);
  back.insert.assign(std::make_move_iterator(first), std::make_move_iterator(last));
  const std::size_t in_place = std::min(remove, insert.size());
  std::move(insert.begin(), place(insert, in_place), first);
  if (insert.size() > remove)
    cues.insert(place(cues, at + in_place), std::make_move_iterator(place(insert, in_place)),
                std::make_move_iterator(insert.end()));
  else
    cues.erase(place(cues, at + in_place), place(cues, at + remove));
  return back;
}

} // namespace

Document::Document(TrackText text, const tactile::Grid &grid, double rate)
    : text_(std::move(text)), grid_(grid), rate_(rate), cues_(text_.cues())
{
}

tl::expected<Document, tactile::FormatError>
Document::read(std::string_view text)
{
  if (!g_utf8_validate(text.data(), static_cast<gssize>(text.size()), nullptr))
    return tl::unexpected(tactile::FormatError{
        .place = {}, .reason = "expected UTF-8; save it as that in a text editor" });
  const auto track = tactile::read_webvtt(text);
  if (!track)
    return tl::unexpected(track.error());
  const tactile::Grid grid{ track->rows(), track->columns() };
  Document document(TrackText(text, grid), grid, track->rate());
  if (document.cues_.size() > kMostCues)
    return tl::unexpected(
        tactile::FormatError{ .place = {},
                              .reason = "expected at most " + std::to_string(kMostCues)
                                        + " cues, got " + std::to_string(document.cues_.size())
                                        + "; tactile-track edit --merge=5 makes fewer" });
  Applied checked = document.check_order();
  for (std::size_t i = 0; i < document.cues_.size() && checked; i++)
    if (checked = document.check(document.cues_[i]); !checked)
      checked = refused("the cue from " + times_of(document.cues_[i]) + ": " + checked.error());
  if (!checked)
    return tl::unexpected(tactile::FormatError{ .place = {}, .reason = checked.error() });
  return document;
}

Applied
Document::check(const Cue &cue) const
{
  if (cue.start < 0 || cue.end <= cue.start || cue.end > kLatest)
    return refused("expected a cue with 0 <= start < end <= " + std::to_string(kLatest)
                   + " ms, got one from " + times_of(cue));
  if (cue.levels.size() != cells())
    return refused("expected " + std::to_string(cells()) + " levels in a cue, got "
                   + std::to_string(cue.levels.size()));
  if (std::ranges::any_of(cue.levels, [](int level) { return level > kMostPercent; }))
    return refused("expected levels from 0 to 100");
  if (cue.notes.size() > kMostNotes || !std::ranges::all_of(cue.notes, is_note))
    return refused("expected at most " + std::to_string(kMostNotes) + " notes of "
                   + std::to_string(kLongestNote)
                   + " bytes, without empty lines and -->, that do not begin with 'tactile'");
  return {};
}

Applied
Document::check_order() const
{
  if (cues_.size() > kMostCues || (2 * cues_.size() + 1) * cells() > tactile::Track::kMaxLevels)
    return refused("the track is full: it has " + std::to_string(cues_.size()) + " cues");
  for (std::size_t i = 1; i < cues_.size(); i++)
    if (cues_[i].start < cues_[i - 1].end)
      return refused("the cue from " + times_of(cues_[i]) + " would overlap the one from "
                     + times_of(cues_[i - 1]));
  return {};
}

tl::expected<std::vector<Splice>, std::string>
Document::apply(const std::vector<Splice> &splices)
{
  Applied applied;
  std::vector<Splice> back; // the last first
  for (const Splice &splice : splices) {
    if (splice.at > cues_.size() || splice.remove > cues_.size() - splice.at)
      applied = refused("expected a splice within " + std::to_string(cues_.size())
                        + " cues, got one at " + std::to_string(splice.at) + " that removes "
                        + std::to_string(splice.remove));
    for (const Cue &cue : splice.insert)
      if (applied)
        applied = check(cue);
    if (!applied)
      break;
    back.push_back(spliced(cues_, splice.at, splice.remove, splice.insert));
  }
  std::ranges::reverse(back);
  if (applied)
    applied = check_order();
  if (applied)
    return back;
  for (Splice &splice : back)
    spliced(cues_, splice.at, splice.remove, std::move(splice.insert));
  return tl::unexpected(applied.error());
}

std::string
Document::text() const
{
  return text_.with(cues_, "tactile " + tactile::write_grid(grid_, rate_));
}

tactile::TactileMap
Document::map(const Cue &cue) const
{
  tactile::TactileMap map(grid_.rows, grid_.columns);
  for (std::size_t i = 0; i < cue.levels.size() && i < map.levels.size(); i++)
    map.levels[i] = static_cast<float>(cue.levels[i]) / static_cast<float>(kMostPercent);
  return map;
}

tactile::Track
Document::track() const
{
  // Cannot fail: cues are in order, and check_order() keeps the limits.
  tactile::Track track(grid_.rows, grid_.columns);
  track.set_rate(rate_);
  const tactile::TactileMap silent(grid_.rows, grid_.columns);
  for (const Cue &cue : cues_) {
    track.append(std::chrono::milliseconds(cue.start), map(cue));
    track.append(std::chrono::milliseconds(cue.end), silent);
  }
  track.set_end(std::chrono::milliseconds(cues_.empty() ? 0 : cues_.back().end));
  return track;
}

} // namespace desk
