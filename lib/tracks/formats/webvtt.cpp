// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/webvtt.h"

#include "tracks/cue_builder.h"
#include "tracks/formats/webvtt_blocks.h"
#include "tracks/formats/webvtt_timing.h"
#include "tracks/text_cue.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace tactile {

namespace {

constexpr std::string_view kSignature = "WEBVTT";

void
append_cue(std::string &text, Time begin, Time end, const TactileMap &map)
{
  text += "\n" + write_webvtt_timing(begin, end) + "\n" + write_text_cue(map) + "\n";
}

/// Reads one file.
class Reader
{
public:
  explicit Reader(std::string_view text) : blocks_(text)
  {
  }

  tl::expected<Track, FormatError> operator()()
  {
    const std::optional<WebvttBlock> first = blocks_.next();
    read_signature(first.value_or(WebvttBlock{}));
    std::size_t last = 1;
    while (!error_) {
      const std::optional<WebvttBlock> block = blocks_.next();
      if (!block)
        break;
      last = block->line;
      read_block(*block);
    }
    if (!track_)
      fail(last, "there is no cue, and no note with a grid");
    else
      (void)track_->set_end(last_end_); // times are up to kMaxEnd
    return std::move(error_).unless_set(track_ ? std::move(*track_) : Track());
  }

private:
  void fail(std::size_t line, std::string reason)
  {
    error_.set(FormatError::at_line(line, std::move(reason)));
  }

  void read_signature(const WebvttBlock &block)
  {
    const bool found = block.line == 1 && block.first.starts_with(kSignature);
    const std::string_view rest = found ? block.first.substr(kSignature.size()) : "";
    if (!found || (!rest.empty() && rest.front() != ' ' && rest.front() != '\t'))
      return fail(1, "expected WEBVTT");
    expect_no_cue(block, "expected an empty line before the first cue");
  }

  /// Anything like a cue after a block's first line is an error.
  void expect_no_cue(const WebvttBlock &block, const char *cue_in_it)
  {
    LineReader lines(block.text);
    for (lines.next(); lines.next();)
      if (has_webvtt_arrow(lines.line()))
        return fail(block.line + lines.number() - 1, cue_in_it);
  }

  void read_block(const WebvttBlock &block)
  {
    if (block.kind == WebvttBlock::Kind::cue)
      return read_cue(block);
    if (block.kind == WebvttBlock::Kind::track_note)
      read_note(block);
    expect_no_cue(block, "expected an empty line before the cue");
  }

  void read_note(const WebvttBlock &block)
  {
    const tl::expected<GridHeader, FormatError> header = read_grid(block.first, block.line);
    if (!header)
      return error_.set(header.error());
    if (track_ && header->grid && *header->grid != Grid{ track_->rows(), track_->columns() })
      return fail(block.line, "another grid than before");
    if (header->grid)
      begin_track(*header->grid);
    rate_ = header->rate;
    if (track_)
      track_->set_rate(rate_);
  }

  void begin_track(const Grid &grid)
  {
    if (!track_)
      track_.emplace(grid.rows, grid.columns);
    track_->set_rate(rate_);
  }

  void read_cue(const WebvttBlock &block)
  {
    const tl::expected<WebvttCueLines, FormatError> cue = read_webvtt_cue_lines(block);
    if (!cue)
      return error_.set(cue.error());
    if (track_ && is_remark(cue->picture))
      return; // without a note for the grid, the first cue decides whether this is a track
    if (!check_times(*cue))
      return;
    std::optional<Grid> grid;
    if (track_)
      grid = { track_->rows(), track_->columns() };
    const tl::expected<TactileMap, FormatError> map
        = read_text_cue(cue->picture, grid, cue->line + 1);
    if (!map)
      return error_.set(map.error());
    begin_track({ map->rows, map->columns });
    auto appended = track_->append(cue->timing.begin, *map);
    if (appended)
      appended = track_->append(cue->timing.end, TactileMap(map->rows, map->columns));
    if (!appended)
      return fail(cue->line, appended.error().reason);
  }

  bool check_times(const WebvttCueLines &cue)
  {
    const WebvttTiming &timing = cue.timing;
    if (timing.end <= timing.begin)
      fail(cue.line, "the cue ends before it begins");
    else if (timing.begin < last_begin_)
      fail(cue.line, "the cue is out of order: the one before begins later, at "
                         + write_webvtt_timestamp(last_begin_));
    else if (timing.begin < last_end_)
      fail(cue.line,
           "the cue overlaps the one before, which ends at " + write_webvtt_timestamp(last_end_));
    last_begin_ = timing.begin;
    last_end_ = timing.end;
    return !error_;
  }

  WebvttBlocks blocks_;
  std::optional<Track> track_;
  double rate_ = 0;
  Time last_begin_{ 0 };
  Time last_end_{ 0 };
  FirstError error_;
};

} // namespace

std::string
write_webvtt(const Track &track)
{
  const Track rounded = at_resolution(track, kTextTick, kTextSteps);
  std::string text = "WEBVTT\n\nNOTE tactile "
                     + write_grid({ track.rows(), track.columns() }, track.rate()) + "\n";
  const auto &entries = rounded.entries();
  for (std::size_t i = 0; i < entries.size(); i++) {
    const bool is_last = i + 1 == entries.size();
    const Time end = is_last ? rounded.end() : entries[i + 1].time;
    Time begin = entries[i].time;
    if (is_silent(entries[i].map)) {
      if (i == 0 && begin < end) {
        const Time first = std::min(end, CueBuilder::kLongest);
        append_cue(text, begin, first, entries[i].map);
        begin = first;
      }
      if (is_last && begin < end)
        append_cue(text, std::max(begin, end - CueBuilder::kLongest), end, entries[i].map);
      continue;
    }
    for (; begin < end; begin += CueBuilder::kLongest)
      append_cue(text, begin, std::min(begin + CueBuilder::kLongest, end), entries[i].map);
  }
  return text;
}

tl::expected<Track, FormatError>
read_webvtt(std::string_view text)
{
  return Reader(text)();
}

bool
is_meant_as_track(std::string_view text)
{
  std::optional<bool> begins_with_map;
  WebvttBlocks blocks(text);
  while (const std::optional<WebvttBlock> block = blocks.next()) {
    if (block->kind == WebvttBlock::Kind::track_note)
      return true;
    if (block->kind == WebvttBlock::Kind::cue && !begins_with_map) {
      const auto cue = read_webvtt_cue_lines(*block);
      begins_with_map = cue && read_text_cue(cue->picture, std::nullopt);
    }
  }
  return begins_with_map.value_or(false);
}

} // namespace tactile
