// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/webvtt_text.h"

#include "tracks/formats/webvtt.h"
#include "tracks/formats/webvtt_blocks.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

namespace tactile {

namespace {

using std::chrono::milliseconds;
using Kind = WebvttBlock::Kind;

/// Continues a file. A line end is not completed by the first byte of what follows.
void
add(std::string &text, std::string_view more)
{
  if (text.ends_with('\r') && more.starts_with('\n'))
    text += '\n';
  text += more;
}

bool
ends_line(std::string_view text)
{
  return text.ends_with('\n') || text.ends_with('\r');
}

/// Makes a note the last one of a cue's, with what does not fit in more lines of it.
void
add_note(std::vector<std::string> &notes, const std::string &note)
{
  if (notes.size() < kMostWebvttNotes)
    notes.push_back(note);
  else if (!note.empty())
    notes.back() += (notes.back().empty() ? "" : "\n") + note;
}

/// The comment of a block, if a cue can have it as a note.
std::optional<std::string>
note_of(const WebvttBlock &block)
{
  if (block.kind != Kind::note)
    return std::nullopt;
  std::string note(block.first.substr(block.first.empty() ? 0 : 1));
  LineReader lines(block.text);
  for (lines.next(); lines.next();)
    note.append(note.empty() && lines.number() == 2 ? "" : "\n").append(lines.line());
  return is_webvtt_note(note) ? std::optional(note) : std::nullopt;
}

bool
gives_grid(const WebvttBlock &block)
{
  if (block.kind != Kind::track_note)
    return false;
  const auto header = read_grid(block.first, block.line);
  return header && header->grid;
}

/// As read_webvtt() does: without a note, the first cue gives the grid.
bool
is_map(const WebvttBlock &block)
{
  if (block.kind != Kind::cue)
    return false;
  const auto cue = read_webvtt_cue_lines(block);
  return cue && !is_remark(cue->picture);
}

Time
time_of(std::int32_t ms)
{
  return milliseconds(ms);
}

/// The words of a track's note with another grid.
std::string
with_grid(std::string_view words, const Grid &grid)
{
  constexpr std::string_view kSeparators = " \t\r\n,;";
  std::string result;
  while (!words.empty()) {
    const std::size_t end = std::min(words.find_first_of(kSeparators), words.size());
    const std::string_view word = words.substr(0, end);
    result += word.starts_with("grid=") ? write_grid(grid, 0) : std::string(word);
    words.remove_prefix(end);
    result += words.substr(0, 1);
    words.remove_prefix(words.empty() ? 0 : 1);
  }
  return result;
}

/// A remark's line of times, moved; empty: it is before 0 then.
std::string
moved_times(const WebvttCueLines &remark, Time offset)
{
  const Time end = remark.timing.end + offset;
  if (end <= Time(0))
    return {};
  return write_webvtt_timing(std::max(remark.timing.begin + offset, Time(0)), end);
}

/// A file whose notes have another grid, and whose remarks are moved.
std::string
with_grid_and_remarks(std::string_view text, const Grid &grid, Time offset)
{
  std::string result;
  std::string_view rest = text;
  const auto replace = [&](std::string_view part, std::string_view by) {
    result.append(rest.substr(0, static_cast<std::size_t>(part.data() - rest.data()))).append(by);
    rest.remove_prefix(static_cast<std::size_t>(part.data() + part.size() - rest.data()));
  };
  WebvttBlocks blocks(text);
  while (const std::optional<WebvttBlock> block = blocks.next()) {
    if (gives_grid(*block))
      replace(block->first, with_grid(block->first, grid));
    if (block->kind != Kind::cue || offset == Time(0))
      continue;
    const auto cue = read_webvtt_cue_lines(*block);
    if (!cue || !is_remark(cue->picture))
      continue;
    const std::string times = moved_times(*cue, offset);
    const auto length = static_cast<std::size_t>(cue->timing.rest.data() - cue->timing_line.data());
    replace(times.empty() ? block->text : cue->timing_line.substr(0, length), times);
  }
  return result.append(rest);
}

} // namespace

WebvttText::WebvttText(std::string text, const Grid &grid)
    : text_(std::make_shared<const std::string>(std::move(text))), grid_(grid)
{
  const std::string_view whole = *text_;
  if (const std::size_t end = whole.find_first_of("\r\n"); end != std::string_view::npos)
    line_end_ = whole.substr(end).starts_with("\r\n") ? "\r\n" : std::string(whole.substr(end, 1));
  read_pieces();
}

void
WebvttText::read_pieces()
{
  const std::string_view whole = *text_;
  std::vector<WebvttBlock> blocks;
  WebvttBlocks reader(whole);
  while (std::optional<WebvttBlock> block = reader.next())
    blocks.push_back(*block);
  // The first cue's comments follow the last block that is none. Without cues they are the tail.
  const auto first_cue = std::ranges::find_if(blocks, is_map);
  auto body = first_cue;
  while (body != blocks.begin() && note_of(*std::prev(body)))
    --body;
  const auto position = [&](std::string_view part) {
    return static_cast<std::size_t>(part.data() - whole.data());
  };
  const auto end_of = [&](const WebvttBlock &block) {
    return position(block.text) + block.text.size();
  };
  header_has_grid_ = std::any_of(blocks.begin(), body, gives_grid);
  has_grid_note_ = std::ranges::any_of(blocks, gives_grid);
  std::size_t from = body == blocks.begin() ? 0 : end_of(*std::prev(body));
  header_ = whole.substr(0, from);

  Piece piece;
  for (auto block = body; block != blocks.end(); ++block) {
    if (is_map(*block)) {
      const std::size_t begin = position(block->text);
      const std::size_t first = std::min(whole.find_first_not_of("\r\n", from), whole.size());
      piece.lead = whole.substr(from, first - from);
      piece.front = whole.substr(first, begin - first);
      read_cue(*block, piece);
      pieces_.push_back(std::exchange(piece, {}));
      from = end_of(*block);
    } else if (const auto note = note_of(*block)) {
      add_note(piece.cue.notes, *note);
    } else {
      piece.has_note_before_kept = !piece.cue.notes.empty();
      piece.kept += block->text;
      if (!ends_line(piece.kept))
        piece.kept += line_end_;
      add(piece.kept, line_end_);
    }
  }
  tail_ = whole.substr(from);
}

void
WebvttText::read_cue(const WebvttBlock &block, Piece &piece) const
{
  const auto lines = read_webvtt_cue_lines(block);
  if (!lines)
    return;
  piece.cue.start = static_cast<std::int32_t>(lines->timing.begin / milliseconds(1));
  piece.cue.end = static_cast<std::int32_t>(lines->timing.end / milliseconds(1));
  piece.identifier = lines->identifier;
  piece.timing = lines->timing_line;
  piece.after_times = piece.timing.substr(
      static_cast<std::size_t>(lines->timing.rest.data() - piece.timing.data()));
  piece.picture = lines->text;
  if (const auto map = read_text_cue(lines->picture, grid_))
    set_map(piece.cue, *map);
}

std::vector<WebvttCue>
WebvttText::cues() const
{
  std::vector<WebvttCue> cues;
  cues.reserve(pieces_.size());
  for (const Piece &piece : pieces_)
    if (piece.cue.end > 0)
      cues.push_back(piece.cue);
  return cues;
}

/// The original piece of each cue, in order; nullptr: none.
std::vector<const WebvttText::Piece *>
WebvttText::origins(const std::vector<WebvttCue> &cues) const
{
  std::vector<const Piece *> origins(cues.size());
  std::vector<const Piece *> rest; // those at whose time no cue begins
  std::size_t i = 0;
  for (const Piece &piece : pieces_) {
    while (i < cues.size() && cues[i].start < piece.cue.start)
      i++;
    if (i < cues.size() && cues[i].start == piece.cue.start)
      origins[i] = &piece;
    else
      rest.push_back(&piece);
  }
  i = 0;
  for (const Piece *piece : rest) {
    while (i < cues.size() && (origins[i] || cues[i].end <= piece->cue.start))
      i++;
    if (i < cues.size() && cues[i].start < piece->cue.end)
      origins[i] = piece;
  }
  return origins;
}

/// Writes a file.
class WebvttText::Builder
{
public:
  explicit Builder(const WebvttText &of) : of_(of), text_(of.header_), piece_(of.pieces_.begin())
  {
  }

  void add_grid_note(double rate)
  {
    end_line();
    add_block("NOTE tactile " + write_grid(of_.grid_, rate) + of_.line_end_);
  }

  /// `origin` is after those of the cues before.
  void add_cue(const WebvttCue &cue, const Piece *origin, const Piece *next_origin, bool is_first)
  {
    while (piece_ != of_.pieces_.end() && &*piece_ != origin && &*piece_ != next_origin
           && (origin || piece_->cue.start < cue.start))
      kept_ += piece_++->kept;
    if (origin)
      ++piece_;
    // The first cue may give the grid, by its lines; in front of it, notes that other blocks follow
    // would be the header's.
    const bool picture_stays = !is_first || origin == of_.pieces_.data() || of_.header_has_grid_;
    const bool front_stays = !is_first || origin == of_.pieces_.data()
                             || (origin && picture_stays && !origin->has_note_before_kept);
    end_line();
    if (origin && front_stays && origin->cue.notes == cue.notes) {
      if (kept_.empty())
        add(text_, origin->lead);
      else
        add_block(std::exchange(kept_, {}));
      text_ += origin->front;
    } else {
      if (origin)
        kept_ += origin->kept;
      add_block(std::exchange(kept_, {}));
      add_notes(cue);
    }
    add_lines(cue, origin, picture_stays && !of_.is_resampled_);
  }

  std::string finish() &&
  {
    for (; piece_ != of_.pieces_.end(); ++piece_)
      kept_ += piece_->kept;
    if (!kept_.empty()) {
      end_line();
      add_block(kept_);
    }
    if (of_.tail_.find_first_not_of("\r\n") != std::string_view::npos)
      end_line();
    add(text_, of_.tail_);
    return std::move(text_);
  }

private:
  void end_line()
  {
    if (!ends_line(text_))
      text_ += of_.line_end_;
  }
  void add_block(std::string_view block)
  {
    add(text_, of_.line_end_);
    text_ += block;
  }
  /// Text of our own, with the file's line ends.
  void add_own(std::string own)
  {
    if (of_.line_end_ != "\n")
      for (std::size_t at = 0; (at = own.find('\n', at)) != std::string::npos;
           at += of_.line_end_.size())
        own.replace(at, 1, of_.line_end_);
    text_ += own;
  }

  void add_notes(const WebvttCue &cue)
  {
    for (const std::string &note : cue.notes) {
      std::string text = "NOTE";
      if (!note.empty())
        text += (note.find('\n') == std::string::npos ? " " : "\n") + note;
      add_own(text + "\n\n");
    }
  }

  void add_lines(const WebvttCue &cue, const Piece *origin, bool picture_stays)
  {
    if (origin)
      text_ += origin->identifier;
    const bool is_same_time
        = origin && !of_.is_moved_ && origin->cue.start == cue.start && origin->cue.end == cue.end;
    if (!is_same_time)
      add_own(write_webvtt_timing(time_of(cue.start), time_of(cue.end)));
    text_ += is_same_time ? origin->timing : origin ? origin->after_times : of_.line_end_;
    if (origin && picture_stays && origin->cue.has_map_of(cue)) {
      text_ += origin->picture;
    } else {
      end_line();
      add_own(write_text_cue(map_of(cue, of_.grid_)) + "\n");
    }
  }

  const WebvttText &of_;
  std::string text_;
  std::string kept_; ///< in front of cues that are gone
  std::vector<Piece>::const_iterator piece_;
};

std::string
WebvttText::with(const std::vector<WebvttCue> &cues, double rate) const
{
  Builder builder(*this);
  if (cues.empty() && !has_grid_note_)
    builder.add_grid_note(rate);
  const std::vector<const Piece *> of = origins(cues);
  std::vector<const Piece *> next(of.size()); // the next origin from each on
  for (std::size_t i = of.size(); i-- > 0;)
    next[i] = of[i] || i + 1 == of.size() ? of[i] : next[i + 1];
  for (std::size_t i = 0; i < cues.size(); i++)
    builder.add_cue(cues[i], of[i], next[i], i == 0);
  return std::move(builder).finish();
}

std::string
WebvttText::with(const Track &track, Time offset) const
{
  WebvttText text = *this;
  text.is_moved_ = offset != Time(0);
  text.grid_ = { track.rows(), track.columns() };
  text.is_resampled_ = text.grid_ != grid_;
  const std::vector<std::uint8_t> silent(
      static_cast<std::size_t>(track.rows()) * static_cast<std::size_t>(track.columns()), 0);
  for (Piece &piece : text.pieces_) {
    const auto moved = [&](std::int32_t ms) {
      return static_cast<std::int32_t>(
          std::chrono::floor<milliseconds>(time_of(ms) + offset).count());
    };
    piece.cue.end = moved(piece.cue.end);
    piece.cue.start = piece.cue.end > 0 ? std::max(moved(piece.cue.start), 0) : piece.cue.end - 1;
    if (text.is_resampled_)
      piece.cue.levels = std::ranges::count(piece.cue.levels, 0)
                                 == static_cast<std::ptrdiff_t>(piece.cue.levels.size())
                             ? silent
                             : std::vector<std::uint8_t>();
  }
  return with_grid_and_remarks(text.with(cues_of(track, text.cues()), track.rate()), text.grid_,
                               offset);
}

} // namespace tactile
