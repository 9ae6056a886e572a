// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactile/mix.h"

#include <algorithm>

namespace tactile {

const char *
name_of(Mix mix)
{
  switch (mix) {
  case Mix::max:
    return "max";
  case Mix::sum:
    return "sum";
  case Mix::gate:
    return "gate";
  case Mix::accent:
    return "accent";
  case Mix::stress:
    return "stress";
  case Mix::replace:
    break;
  }
  return "replace";
}

bool
is_silent(const TactileMap &map)
{
  return std::ranges::all_of(map.levels, [](float level) { return !(level > 0); });
}

TactileMap
resample(const TactileMap &map, int rows, int columns)
{
  if (map.rows == rows && map.columns == columns)
    return map;
  TactileMap result(rows, columns);
  result.frequency = map.frequency;
  // The share of cell `c` of `to` that source cell `s` of `from` covers.
  const auto share = [](int s, int from, int c, int to) {
    const double begin = std::max(static_cast<double>(s) / from, static_cast<double>(c) / to);
    const double end = std::min(static_cast<double>(s + 1) / from, static_cast<double>(c + 1) / to);
    return std::max(end - begin, 0.0) * to;
  };
  for (int row = 0; row < result.rows; row++)
    for (int column = 0; column < result.columns; column++) {
      double sum = 0;
      for (int r = row * map.rows / result.rows; r < map.rows; r++) {
        const double of_rows = share(r, map.rows, row, result.rows);
        if (of_rows == 0)
          break;
        for (int c = column * map.columns / result.columns; c < map.columns; c++) {
          const double of_columns = share(c, map.columns, column, result.columns);
          if (of_columns == 0)
            break;
          sum += static_cast<double>(map.at(r, c)) * of_rows * of_columns;
        }
      }
      result.at(row, column) = static_cast<float>(std::min(sum, 1.0));
    }
  return result;
}

void
mix_into(TactileMap &map, const TactileMap &over, Mix mix)
{
  const TactileMap top = resample(over, map.rows, map.columns);
  const float place = std::ranges::max(map.levels);
  const float strength = std::ranges::max(top.levels);
  switch (mix) {
  case Mix::replace:
    if (strength > 0)
      map = top;
    return;
  case Mix::gate:
  case Mix::accent:
  case Mix::stress:
    if (place <= 0) {
      map = mix == Mix::stress ? map : top;
    } else if (mix == Mix::gate || strength > place) {
      map.frequency = top.frequency;
      std::ranges::for_each(map.levels, [&](float &level) { level *= strength / place; });
    }
    return;
  case Mix::max:
  case Mix::sum:
    if (strength > place)
      map.frequency = top.frequency;
    std::ranges::transform(map.levels, top.levels, map.levels.begin(), [mix](float a, float b) {
      return mix == Mix::sum ? std::min(a + b, 1.0F) : std::max(a, b);
    });
  }
}

} // namespace tactile
