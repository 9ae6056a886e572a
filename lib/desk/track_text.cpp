// SPDX-License-Identifier: LGPL-2.1-or-later
#include "desk/track_text.h"

#include "tracks/formats/webvtt_timing.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace desk {

namespace {

/// A line of a file, without and with its line end.
struct Line
{
  std::string_view text;
  std::string_view whole;
};

/// Takes the next line, with Unix, Windows or classic Mac line ends.
Line
take_line(std::string_view &rest)
{
  const std::size_t length = std::min(rest.find_first_of("\r\n"), rest.size());
  std::size_t whole = length;
  if (rest.substr(length).starts_with("\r\n"))
    whole += 2;
  else if (length < rest.size())
    whole += 1;
  const Line line{ rest.substr(0, length), rest.substr(0, whole) };
  rest.remove_prefix(whole);
  return line;
}

bool
begins_with_word(std::string_view line, std::string_view word)
{
  if (!line.starts_with(word))
    return false;
  line.remove_prefix(word.size());
  return line.empty() || line.front() == ' ' || line.front() == '\t';
}

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
  if (notes.size() < kMostNotes)
    notes.push_back(note);
  else if (!note.empty())
    notes.back() += (notes.back().empty() ? "" : "\n") + note;
}

std::int32_t
milliseconds(tactile::Time time)
{
  return static_cast<std::int32_t>(
      std::chrono::duration_cast<std::chrono::milliseconds>(time).count());
}

} // namespace

bool
is_note(std::string_view note)
{
  return note.size() <= kLongestNote && note.find(tactile::kWebvttArrow) == std::string_view::npos
         && note.find("\n\n") == std::string_view::npos && !note.starts_with('\n')
         && !note.ends_with('\n') && note.find_first_of(std::string_view("\r\0", 2)) == note.npos
         && !tactile::webvtt_tactile_note(note.substr(0, note.find('\n')));
}

/// Lines between empty ones.
struct TrackText::Block
{
  enum class Kind
  {
    cue,
    note,
    other, ///< the signature, styles, regions, and notes that the desk leaves alone
  };
  std::string lead; ///< empty lines before it
  std::string text;
  std::vector<std::string> lines; ///< without line ends
  Kind kind = Kind::other;
  bool has_grid = false; ///< of a note
  std::string note{};

  /// As tactile::read_webvtt() tells them apart.
  void find_kind()
  {
    constexpr std::string_view kNote = "NOTE";
    if (begins_with_word(lines.front(), "STYLE") || begins_with_word(lines.front(), "REGION"))
      return;
    if (!begins_with_word(lines.front(), kNote)) {
      kind = Kind::cue;
      return;
    }
    const std::string first = lines.front().substr(kNote.size());
    if (const auto words = tactile::webvtt_tactile_note(first)) {
      const auto header = tactile::read_grid(*words, 0);
      has_grid = header && header->grid;
      return;
    }
    note = first.substr(first.empty() ? 0 : 1);
    for (std::size_t i = 1; i < lines.size(); i++)
      note += (note.empty() && i == 1 ? "" : "\n") + lines[i];
    kind = is_note(note) ? Kind::note : Kind::other;
  }
};

std::vector<TrackText::Block>
TrackText::blocks_of(std::string_view text, std::string &tail)
{
  std::vector<Block> blocks;
  bool in_block = false;
  while (!text.empty()) {
    const Line line = take_line(text);
    if (line.text.empty()) {
      in_block = false;
      tail += line.whole;
      continue;
    }
    if (!in_block)
      blocks.push_back({ .lead = std::exchange(tail, {}), .text = {}, .lines = {} });
    in_block = true;
    blocks.back().text += line.whole;
    blocks.back().lines.emplace_back(line.text);
  }
  for (std::size_t i = 1; i < blocks.size(); i++) // after the signature
    blocks[i].find_kind();
  return blocks;
}

TrackText::TrackText(std::string_view text, const tactile::Grid &grid) : grid_(grid)
{
  if (const std::size_t end = text.find_first_of("\r\n"); end != std::string_view::npos)
    line_end_ = text.substr(end).starts_with("\r\n") ? "\r\n" : std::string(text.substr(end, 1));
  const std::vector<Block> blocks = blocks_of(text, tail_);
  const auto is_cue = [](const Block &block) {
    return block.kind == Block::Kind::cue;
  };
  const auto first_cue = std::ranges::find_if(blocks, is_cue);
  // The first cue's comments follow the last block that is none. Without cues they are the tail.
  auto body = first_cue;
  while (body != blocks.begin() && std::prev(body)->kind == Block::Kind::note)
    --body;
  for (auto block = blocks.begin(); block != body; ++block)
    header_ += block->lead + block->text;
  header_has_grid_
      = std::any_of(blocks.begin(), body, [](const Block &block) { return block.has_grid; });
  has_grid_note_ = std::ranges::any_of(blocks, &Block::has_grid);

  Piece piece;
  for (auto block = body; block != blocks.end(); ++block) {
    if (piece.text.empty())
      piece.lead = block->lead;
    else
      piece.text += block->lead;
    piece.text += block->text;
    if (is_cue(*block)) {
      read_cue(*block, piece);
      pieces_.push_back(std::exchange(piece, {}));
    } else if (block->kind == Block::Kind::note) {
      add_note(piece.cue.notes, block->note);
    } else {
      piece.has_note_before_kept = !piece.cue.notes.empty();
      piece.kept += block->text;
      if (!ends_line(piece.kept))
        piece.kept += line_end_;
      add(piece.kept, line_end_);
    }
  }
  tail_ = piece.lead + piece.text + tail_;
}

void
TrackText::read_cue(const Block &block, Piece &piece) const
{
  const bool is_named = block.lines.front().find(tactile::kWebvttArrow) == std::string::npos;
  if (is_named)
    piece.identifier = block.lines.front();
  const std::size_t first = is_named ? 1 : 0;
  const auto timing = tactile::read_webvtt_timing(block.lines[first]);
  if (!timing)
    return;
  piece.cue.start = milliseconds(timing->begin);
  piece.cue.end = milliseconds(timing->end);
  piece.settings = timing->settings;
  std::string picture;
  for (std::size_t i = first + 1; i < block.lines.size(); i++)
    picture += block.lines[i] + "\n";
  if (const auto map = tactile::read_text_cue(picture, grid_))
    for (const float level : map->levels)
      piece.cue.levels.push_back(static_cast<std::uint8_t>(std::lround(level * 100.0F)));
}

std::vector<Cue>
TrackText::cues() const
{
  std::vector<Cue> cues;
  cues.reserve(pieces_.size());
  for (const Piece &piece : pieces_)
    cues.push_back(piece.cue);
  return cues;
}

std::string
TrackText::written(const Cue &cue, const Piece *before) const
{
  const auto time = [](std::int32_t ms) {
    return tactile::Time(std::chrono::milliseconds(ms));
  };
  std::string text;
  for (const std::string &note : cue.notes) {
    text += "NOTE";
    if (!note.empty())
      text += (note.find('\n') == std::string::npos ? " " : "\n") + note;
    text += "\n\n";
  }
  if (before && !before->identifier.empty())
    text += before->identifier + "\n";
  text += tactile::write_webvtt_timing(time(cue.start), time(cue.end));
  if (before && !before->settings.empty())
    text += " " + before->settings;
  tactile::TactileMap map(grid_.rows, grid_.columns);
  for (std::size_t i = 0; i < cue.levels.size() && i < map.levels.size(); i++)
    map.levels[i] = static_cast<float>(cue.levels[i]) / static_cast<float>(kMostPercent);
  text += "\n" + tactile::write_text_cue(map) + "\n";
  if (line_end_ != "\n")
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos;
         at += line_end_.size())
      text.replace(at, 1, line_end_);
  return text;
}

std::string
TrackText::with(const std::vector<Cue> &cues, const std::string &grid_note) const
{
  std::string text = header_;
  const auto end_line = [&] {
    if (!ends_line(text))
      text += line_end_;
  };
  const auto add_block = [&](std::string_view block) {
    add(text, line_end_);
    text += block;
  };
  if (cues.empty() && !has_grid_note_) {
    end_line();
    add_block("NOTE " + grid_note + line_end_);
  }
  std::string kept; // in front of cues that are gone
  auto piece = pieces_.begin();
  for (const Cue &cue : cues) {
    for (; piece != pieces_.end() && piece->cue.start < cue.start; ++piece)
      kept += piece->kept;
    const Piece *before
        = piece != pieces_.end() && piece->cue.start == cue.start ? &*piece++ : nullptr;
    // In front of the first cue, notes that other blocks follow would be the header's; and it may
    // give the grid, by its lines.
    const bool can_stay = &cue != &cues.front() || (before && before == &pieces_.front())
                          || (before && header_has_grid_ && !before->has_note_before_kept);
    const bool is_same = before && before->cue == cue && can_stay;
    end_line();
    if (is_same && kept.empty())
      add(text, before->lead);
    if (before && !is_same)
      kept += before->kept;
    if (!is_same || !kept.empty())
      add_block(std::exchange(kept, {}));
    text += is_same ? before->text : written(cue, before);
  }
  for (; piece != pieces_.end(); ++piece)
    kept += piece->kept;
  if (!kept.empty()) {
    end_line();
    add_block(kept);
  }
  if (tail_.find_first_not_of("\r\n") != std::string::npos)
    end_line();
  add(text, tail_);
  return text;
}

} // namespace desk
