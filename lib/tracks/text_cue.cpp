// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/text_cue.h"

#include "text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>
#include <vector>

namespace tactile {

namespace {

constexpr std::size_t kMaxNumbers
    = static_cast<std::size_t>(kMaxGridSide) * static_cast<std::size_t>(kMaxGridSide);

constexpr std::string_view kNoBreakSpace = "\u00a0";

/// Skips white space up to the end of the line.
void
skip_space(std::string_view &text)
{
  for (;;) {
    if (text.starts_with(kNoBreakSpace))
      text.remove_prefix(kNoBreakSpace.size());
    else if (!text.empty() && (text.front() == ' ' || text.front() == '\t' || text.front() == '\r'))
      text.remove_prefix(1);
    else
      return;
  }
}

tl::unexpected<FormatError>
wrong(std::size_t line, std::string reason)
{
  return tl::unexpected(FormatError::at_line(line, std::move(reason)));
}

/// Consumes a level in percent.
tl::expected<float, FormatError>
take_level(std::string_view &text, std::size_t line)
{
  double percent = 0;
  const auto [end, error]
      = std::from_chars(text.data(), text.data() + text.size(), percent, std::chars_format::fixed);
  if (error != std::errc() || !(percent >= 0 && percent <= 100))
    return wrong(
        line, "expected levels from 0 to 100 percent, got '"
                  + std::string(text.substr(0, text.find_first_of(" \t\r\n"))).substr(0, 20)
                  + (error != std::errc() ? "'; a remark with numbers is written as a NOTE" : "'"));
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  if (text.starts_with('%'))
    text.remove_prefix(1);
  if (!text.empty() && !text.starts_with(kNoBreakSpace)
      && std::string_view(" \t\r\n").find(text.front()) == std::string_view::npos)
    return wrong(line, "expected white space between levels");
  return static_cast<float>(percent / 100);
}

/// Removes "120 Hz" from the end; 0: there is none, or it is none that a map can have.
float
take_frequency(std::string_view &text, bool &is_valid)
{
  constexpr std::string_view kUnit = "Hz";
  const auto trim = [&] {
    while (!text.empty() && std::string_view(" \t\r\n").find(text.back()) != text.npos)
      text.remove_suffix(1);
  };
  const std::string_view whole = text;
  trim();
  is_valid = true;
  if (!text.ends_with(kUnit)) {
    text = whole;
    return 0;
  }
  text.remove_suffix(kUnit.size());
  trim();
  const std::size_t first = text.find_last_not_of(".0123456789") + 1;
  float frequency = 0;
  const auto [end, error] = std::from_chars(text.data() + first, text.data() + text.size(),
                                            frequency, std::chars_format::fixed);
  is_valid = error == std::errc() && end == text.data() + text.size() && frequency >= 1
             && frequency <= kHighestFrequency;
  text = text.substr(0, first);
  return is_valid ? frequency : 0;
}

/// Consumes a number of rows or columns.
bool
take_side(std::string_view &text, int &side)
{
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), side);
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return error == std::errc() && side >= kMinGridSide && side <= kMaxGridSide;
}

} // namespace

std::string
write_text_cue(const TactileMap &map)
{
  std::string text;
  for (int row = 0; row < map.rows; row++) {
    for (int column = 0; column < map.columns; column++) {
      const std::string percent
          = std::to_string(static_cast<int>(std::lround(map.at(row, column) * 100.0F)));
      text.append((column > 0 ? 4 : 3) - std::min<std::size_t>(percent.size(), 3), ' ');
      text += percent;
    }
    if (row + 1 < map.rows)
      text += '\n';
  }
  if (map.frequency > 0)
    text += "\n" + std::to_string(std::max(std::lround(map.frequency), 1L)) + " Hz";
  return text;
}

tl::expected<TactileMap, FormatError>
read_text_cue(std::string_view text, std::optional<Grid> grid, std::size_t first_line)
{
  bool is_frequency = true;
  const float frequency = take_frequency(text, is_frequency);
  if (!is_frequency)
    return wrong(first_line, "expected a frequency from 1 to 1000 Hz");
  std::vector<float> levels;
  std::size_t line = first_line;
  std::size_t columns = 0;
  std::size_t in_row = 0;
  std::size_t rows = 0;
  /// False if the row must be, and is not, as long as those before.
  const auto end_row = [&] {
    if (in_row == 0)
      return true;
    if (!grid && columns != 0 && in_row != columns)
      return false;
    columns = in_row;
    in_row = 0;
    rows++;
    return true;
  };
  const auto uneven = [&] {
    return wrong(line, "expected " + std::to_string(columns) + " levels as in the rows before, got "
                           + std::to_string(in_row));
  };
  for (skip_space(text); !text.empty(); skip_space(text)) {
    if (text.front() == '\n') {
      text.remove_prefix(1);
      if (!end_row())
        return uneven();
      line++;
      continue;
    }
    if (levels.size() == kMaxNumbers)
      return wrong(line, "more levels than the largest grid has, 64 x 64");
    const tl::expected<float, FormatError> level = take_level(text, line);
    if (!level)
      return tl::unexpected(level.error());
    levels.push_back(*level);
    in_row++;
  }
  if (!end_row())
    return uneven();

  if (levels.empty())
    return wrong(first_line, "expected levels in percent, got nothing");
  if (!grid) {
    constexpr auto kMost = static_cast<std::size_t>(kMaxGridSide);
    if (rows > kMost || columns > kMost)
      return wrong(line, "expected at most 64 rows of at most 64 levels");
    grid = { static_cast<int>(rows), static_cast<int>(columns) };
  }
  TactileMap map(grid->rows, grid->columns);
  if (levels.size() != map.levels.size())
    return wrong(first_line, "expected " + std::to_string(map.levels.size())
                                 + " levels for a grid of " + std::to_string(map.rows) + "x"
                                 + std::to_string(map.columns) + ", got "
                                 + std::to_string(levels.size()));
  map.levels = std::move(levels);
  map.frequency = frequency;
  return map;
}

bool
is_remark(std::string_view text)
{
  const auto is_space = [](std::string_view rest) {
    return rest.starts_with(kNoBreakSpace) || rest.starts_with('\n')
           || (!rest.empty() && std::string_view(" \t\r").find(rest.front()) != rest.npos);
  };
  const auto is_digit = [](char c) {
    return c >= '0' && c <= '9';
  };
  bool has_words = false;
  for (bool in_word = false; !text.empty(); text.remove_prefix(1)) {
    if (is_space(text)) {
      text.remove_prefix(text.starts_with(kNoBreakSpace) ? kNoBreakSpace.size() - 1 : 0);
      in_word = false;
    } else if (!std::exchange(in_word, true)) {
      has_words = true;
      const std::string_view digits
          = text.substr(std::min(text.find_first_not_of("+-."), text.size()));
      if (!digits.empty() && is_digit(digits.front()))
        return false;
    }
  }
  return has_words;
}

std::string
write_grid(const Grid &grid, double rate)
{
  std::string text = "grid=" + std::to_string(grid.rows) + "x" + std::to_string(grid.columns);
  if (rate > 0) {
    std::array<char, 32> number;
    text += " rate=";
    text.append(number.data(),
                std::to_chars(number.data(), number.data() + number.size(), rate).ptr);
  }
  return text;
}

tl::expected<GridHeader, FormatError>
read_grid(std::string_view words, std::size_t line)
{
  GridHeader header;
  for (skip_space(words); !words.empty(); skip_space(words)) {
    std::string_view word = words.substr(0, words.find_first_of(" \t\r\n,;"));
    words.remove_prefix(std::max<std::size_t>(word.size(), 1));
    if (word.starts_with("grid=")) {
      Grid grid;
      word.remove_prefix(5);
      bool valid = take_side(word, grid.rows) && word.starts_with('x');
      if (valid)
        word.remove_prefix(1);
      if (!valid || !take_side(word, grid.columns) || !word.empty())
        return wrong(line, "expected grid=ROWSxCOLUMNS, 1 to 64 each");
      header.grid = grid;
    } else if (word.starts_with("rate=")) {
      word.remove_prefix(5);
      const auto rate = visuotactile::read_number<double>(word);
      if (!rate || !(*rate >= 0 && *rate <= 1000))
        return wrong(line, "expected rate=HZ, 0 to 1000");
      header.rate = *rate;
    }
  }
  return header;
}

} // namespace tactile
