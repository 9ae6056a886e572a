// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/webvtt_blocks.h"

#include <utility>

namespace tactile {

namespace {

bool
begins_with_word(std::string_view line, std::string_view word)
{
  if (!line.starts_with(word))
    return false;
  line.remove_prefix(word.size());
  return line.empty() || line.front() == ' ' || line.front() == '\t';
}

/// The whole lines from the beginning of one view to the end of another behind it.
std::string_view
joined(std::string_view from, std::string_view to)
{
  return { from.data(), static_cast<std::size_t>(to.data() + to.size() - from.data()) };
}

void
find_kind(WebvttBlock &block)
{
  constexpr std::string_view kNote = "NOTE";
  if (begins_with_word(block.first, "STYLE") || begins_with_word(block.first, "REGION")) {
    block.kind = WebvttBlock::Kind::style;
  } else if (begins_with_word(block.first, kNote)) {
    block.kind = WebvttBlock::Kind::note;
    block.first.remove_prefix(kNote.size());
    if (const auto words = webvtt_tactile_note(block.first)) {
      block.kind = WebvttBlock::Kind::track_note;
      block.first = *words;
    }
  } else {
    block.kind = WebvttBlock::Kind::cue;
  }
}

} // namespace

WebvttBlocks::WebvttBlocks(std::string_view text) : lines_(text), has_line_(lines_.next())
{
}

std::optional<WebvttBlock>
WebvttBlocks::next()
{
  for (; has_line_ && lines_.line().empty(); has_line_ = lines_.next())
    lead_ = lead_.empty() ? lines_.whole() : joined(lead_, lines_.whole());
  if (!has_line_)
    return std::nullopt;
  WebvttBlock block{ .line = lines_.number(),
                     .lead = std::exchange(lead_, {}),
                     .text = lines_.whole(),
                     .first = lines_.line() };
  while ((has_line_ = lines_.next()) && !lines_.line().empty())
    block.text = joined(block.text, lines_.whole());
  if (block.line > 1)
    find_kind(block);
  return block;
}

bool
has_webvtt_arrow(std::string_view line)
{
  return line.find(kWebvttArrow) != std::string_view::npos;
}

tl::expected<WebvttCueLines, FormatError>
read_webvtt_cue_lines(const WebvttBlock &block)
{
  WebvttCueLines cue;
  LineReader lines(block.text);
  lines.next();
  if (!has_webvtt_arrow(lines.line())) {
    cue.identifier = lines.whole();
    if (!lines.next() || !has_webvtt_arrow(lines.line()))
      return tl::unexpected(FormatError::at_line(block.line, "expected a cue: START --> END"));
  }
  cue.line = block.line + lines.number() - 1;
  cue.timing_line = lines.whole();
  const std::optional<WebvttTiming> timing = read_webvtt_timing(lines.line());
  if (!timing)
    return tl::unexpected(
        FormatError::at_line(cue.line, "expected HH:MM:SS.mmm --> HH:MM:SS.mmm, up to 100 hours"));
  cue.timing = *timing;
  while (lines.next()) {
    cue.text = cue.text.empty() ? lines.whole() : joined(cue.text, lines.whole());
    cue.picture += lines.line();
    cue.picture += '\n';
  }
  return cue;
}

} // namespace tactile
