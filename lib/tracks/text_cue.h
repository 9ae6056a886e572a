// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/tactile_map.h"
#include "tracks/format_error.h"

#include <optional>
#include <string>
#include <string_view>

namespace tactile {

/// Rows and columns of a map.
struct Grid
{
  int rows = 0;
  int columns = 0;

  bool operator==(const Grid &) const = default;
};

/// A map as a picture, the designer's form: a line for each row as seen on the screen, levels in
/// whole percents, right-aligned. Nothing in it means anything to a subtitle format (no < > & ").
///
///      0   0   0
///      0  75  75
///      0   0   0
std::string write_text_cue(const TactileMap &map);

/// Reads such a picture. Any white space separates numbers, also no-break spaces; each may have a
/// `%`. With `grid`, as many numbers as it has cells, on any number of lines; without, each line is
/// a row. An error has its line; lines count from `first_line`.
tl::expected<TactileMap, FormatError> read_text_cue(std::string_view text, std::optional<Grid> grid,
                                                    std::size_t first_line = 1);

/// "grid=3x3 rate=5", as it stands in headers of tracks; without a rate if that is 0.
std::string write_grid(const Grid &grid, double rate);

/// What a header says; other words are ignored.
struct GridHeader
{
  std::optional<Grid> grid;
  double rate = 0;
};

/// Reads words such as "grid=3x3 rate=5". An error, on line `line`, if one of the two is not what
/// it has to be.
tl::expected<GridHeader, FormatError> read_grid(std::string_view words, std::size_t line);

} // namespace tactile
