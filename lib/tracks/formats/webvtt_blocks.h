// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/format_error.h"
#include "tracks/formats/line_reader.h"
#include "tracks/formats/webvtt_timing.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace tactile {

/// Lines of a WebVTT file between empty ones. The views are of the file.
struct WebvttBlock
{
  enum class Kind
  {
    signature, ///< what the first line begins
    note,
    track_note, ///< "NOTE tactile grid=3x3 rate=5"
    style,      ///< or a region
    cue,
  };
  Kind kind = Kind::signature;
  std::size_t line = 0;  ///< number of its first line, from 1
  std::string_view lead; ///< empty lines before it
  std::string_view text; ///< its lines, with their line ends
  /// The first line, without its line end; in a note without "NOTE", in a track's note without
  /// "NOTE tactile".
  std::string_view first;
};

/// Iterates over the blocks of a WebVTT file: the one definition of a block.
class WebvttBlocks
{
public:
  explicit WebvttBlocks(std::string_view text);

  /// Advances to the next block; none at the end.
  std::optional<WebvttBlock> next();

  /// After the last block: the empty lines that the file ends with.
  std::string_view tail() const
  {
    return lead_;
  }

private:
  LineReader lines_;
  bool has_line_;
  std::string_view lead_;
};

/// Whether a line has "-->".
bool has_webvtt_arrow(std::string_view line);

/// The parts of a block with a cue. The views are of the file.
struct WebvttCueLines
{
  std::string_view identifier; ///< its line with the line end; empty: none
  std::size_t line = 0;        ///< number of the line of times
  WebvttTiming timing;
  std::string_view timing_line; ///< with its line end
  std::string_view text;        ///< the lines after it
  std::string picture;          ///< the same, each ended by \n
};

/// The end may be before the beginning.
tl::expected<WebvttCueLines, FormatError> read_webvtt_cue_lines(const WebvttBlock &block);

} // namespace tactile
