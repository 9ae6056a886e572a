// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/tactile_map.h"
#include "tracks/format_error.h"

#include <optional>
#include <string>
#include <string_view>

namespace tactile {

struct Grid
{
  int rows = 0;
  int columns = 0;

  bool operator==(const Grid &) const = default;
};

/// Writes a map as a picture for designers: a line per row as seen on the screen, levels in whole
/// percent, right-aligned. It contains no markup of subtitle formats (no < > & ").
///
///      0   0   0
///      0  75  75
///      0   0   0
///
/// A map with a frequency has a last line such as "120 Hz".
std::string write_text_cue(const TactileMap &map);

/// Reads such a picture. Numbers are separated by any white space, including no-break spaces, and
/// may end with `%`. With `grid`, there must be one number per cell, on any number of lines.
/// Without it, each line is a row. Errors give the line, counted from `first_line`.
tl::expected<TactileMap, FormatError> read_text_cue(std::string_view text, std::optional<Grid> grid,
                                                    std::size_t first_line = 1);

/// Whether a text is a remark among the maps of a track: it has words, none of which begins as a
/// number does. Remarks are shown, not felt. Any other text that is no map is a faulty one.
bool is_remark(std::string_view text);

/// Writes "grid=3x3 rate=5", for the headers of tracks; no rate if it is 0.
std::string write_grid(const Grid &grid, double rate);

/// The known words of a header; others are ignored.
struct GridHeader
{
  std::optional<Grid> grid;
  double rate = 0;
};

/// Reads words such as "grid=3x3 rate=5". If a known word is invalid, the error gives `line`.
tl::expected<GridHeader, FormatError> read_grid(std::string_view words, std::size_t line);

} // namespace tactile
