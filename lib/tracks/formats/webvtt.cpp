// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/webvtt.h"

#include "tracks/cue_builder.h"
#include "tracks/formats/line_reader.h"
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
  explicit Reader(std::string_view text) : lines_(text)
  {
  }

  tl::expected<Track, FormatError> operator()()
  {
    read_signature();
    while (!error_ && lines_.next())
      if (!lines_.line().empty())
        read_block();
    if (!track_)
      fail(lines_.number(), "there is no cue, and no note with a grid");
    else
      track_->set_end(last_end_);
    return std::move(error_).unless_set(track_ ? std::move(*track_) : Track());
  }

private:
  void fail(std::size_t line, std::string reason)
  {
    error_.set(FormatError::at_line(line, std::move(reason)));
  }

  void read_signature()
  {
    const bool found = lines_.next() && lines_.line().starts_with(kSignature);
    const std::string_view rest
        = found ? lines_.line().substr(kSignature.size()) : std::string_view();
    if (!found || (!rest.empty() && rest.front() != ' ' && rest.front() != '\t'))
      return fail(1, "expected WEBVTT");
    skip_block("expected an empty line before the first cue");
  }

  /// Skips to the next empty line. Anything like a cue before that is an error.
  void skip_block(const char *cue_in_it)
  {
    while (!error_ && lines_.next() && !lines_.line().empty())
      if (lines_.line().find(kWebvttArrow) != std::string_view::npos)
        fail(lines_.number(), cue_in_it);
  }

  /// Reads a block: from a nonempty line to the next empty one.
  void read_block()
  {
    const std::string_view first = lines_.line();
    const auto is = [&](std::string_view word) {
      return first == word || first.starts_with(std::string(word) + " ")
             || first.starts_with(std::string(word) + "\t");
    };
    if (is("NOTE"))
      read_note(first.substr(4));
    else if (!is("STYLE") && !is("REGION"))
      return read_cue();
    skip_block("expected an empty line before the cue");
  }

  void read_note(std::string_view text)
  {
    const std::optional<std::string_view> words = webvtt_tactile_note(text);
    if (!words)
      return;
    const tl::expected<GridHeader, FormatError> header = read_grid(*words, lines_.number());
    if (!header)
      return error_.set(header.error());
    if (track_ && header->grid && *header->grid != Grid{ track_->rows(), track_->columns() })
      return fail(lines_.number(), "another grid than before");
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

  void read_cue()
  {
    if (lines_.line().find(kWebvttArrow) == std::string_view::npos) { // an identifier
      const std::size_t number = lines_.number();
      if (!lines_.next() || lines_.line().find(kWebvttArrow) == std::string_view::npos)
        return fail(number, "expected a cue: START --> END");
    }
    const std::size_t number = lines_.number();
    Time begin{ 0 };
    Time end{ 0 };
    if (!read_timing(lines_.line(), begin, end))
      return;
    const std::string text = take_text();
    std::optional<Grid> grid;
    if (track_)
      grid = { track_->rows(), track_->columns() };
    const tl::expected<TactileMap, FormatError> map = read_text_cue(text, grid, number + 1);
    if (!map)
      return error_.set(map.error());
    begin_track({ map->rows, map->columns });
    auto appended = track_->append(begin, *map);
    if (appended)
      appended = track_->append(end, TactileMap(map->rows, map->columns));
    if (!appended)
      return fail(number, appended.error().reason);
    last_end_ = end;
  }

  /// The lines up to the next empty one.
  std::string take_text()
  {
    std::string text;
    while (lines_.next() && !lines_.line().empty()) {
      text += lines_.line();
      text += '\n';
    }
    return text;
  }

  bool read_timing(std::string_view line, Time &begin, Time &end)
  {
    const std::optional<WebvttTiming> timing = read_webvtt_timing(line);
    if (!timing)
      fail(lines_.number(), "expected HH:MM:SS.mmm --> HH:MM:SS.mmm, up to 100 hours");
    else if (timing->end <= timing->begin)
      fail(lines_.number(), "the cue ends before it begins");
    else if (timing->begin < last_end_)
      fail(lines_.number(),
           "the cue overlaps the one before, which ends at " + write_webvtt_timestamp(last_end_));
    if (error_)
      return false;
    begin = timing->begin;
    end = timing->end;
    return true;
  }

  LineReader lines_;
  std::optional<Track> track_;
  double rate_ = 0;
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
is_tactile_webvtt(std::string_view text)
{
  constexpr std::string_view kNote = "NOTE";
  for (LineReader lines(text); lines.next();)
    if (lines.line().starts_with(kNote) && webvtt_tactile_note(lines.line().substr(kNote.size())))
      return true;
  return false;
}

} // namespace tactile
