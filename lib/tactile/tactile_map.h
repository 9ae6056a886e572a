// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

/// The value that passes from the film's side to the chair's side.
namespace tactile {

/// Smallest and largest number of rows or columns.
inline constexpr int kMinGridSide = 1;
inline constexpr int kMaxGridSide = 64;

/// The highest frequency of a map, in Hz; the lowest is 1.
inline constexpr float kHighestFrequency = 1000;

/// Levels of a grid of tactors at one moment: `rows × columns` values in [0, 1], row-major,
/// starting with the top left tactor as seen on the screen (paper, Section 3: "a tactile map such
/// as a 3×3 array").
struct TactileMap
{
  int rows = 0;
  int columns = 0;
  std::vector<float> levels;
  /// Frequency of the vibrations in Hz, for actuators that have a choice; 0: the actuator's own.
  float frequency = 0;

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
