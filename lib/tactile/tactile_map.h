// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

/// The one value that the film's side and the chair's side share.
namespace tactile {

/// Smallest and largest number of rows or columns of a grid of tactors.
inline constexpr int kMinGridSide = 1;
inline constexpr int kMaxGridSide = 64;

/// What a grid of tactors shall do at one moment: `rows × columns` levels in [0, 1], row-major, the
/// top left tactor as seen on the screen first (paper, Section 3: "a tactile map such as a 3×3
/// array").
struct TactileMap
{
  int rows = 0;
  int columns = 0;
  std::vector<float> levels;

  TactileMap() = default;

  /// A silent map. Rows and columns are clamped to [kMinGridSide, kMaxGridSide].
  TactileMap(int rows_, int columns_)
      : rows(std::clamp(rows_, kMinGridSide, kMaxGridSide)),
        columns(std::clamp(columns_, kMinGridSide, kMaxGridSide)),
        levels(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns), 0.0F)
  {
  }

  float &at(int row, int column)
  {
    return levels[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns)
                  + static_cast<std::size_t>(column)];
  }

  float at(int row, int column) const
  {
    return levels[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns)
                  + static_cast<std::size_t>(column)];
  }

  bool operator==(const TactileMap &) const = default;
};

} // namespace tactile
