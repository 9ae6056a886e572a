// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synth/channel_cells.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace synth {

namespace {

bool
is_front(Place place)
{
  return place == Place::front_left || place == Place::front_center || place == Place::front_right;
}

/// The cells at place `index` of `count` side by side.
std::vector<int>
side_by_side(int rows, int columns, int index, int count)
{
  const int first = index * columns / count;
  const int last = ((index + 1) * columns + count - 1) / count;
  std::vector<int> cells;
  for (int row = 0; row < rows; row++)
    for (int column = first; column < last; column++)
      cells.push_back(row * columns + column);
  return cells;
}

} // namespace

ChannelCells
mapped_cells(std::span<const int> mapping, int channels)
{
  ChannelCells cells(static_cast<std::size_t>(channels));
  for (std::size_t cell = 0; cell < mapping.size(); cell++)
    if (mapping[cell] >= 0 && mapping[cell] < channels)
      cells[static_cast<std::size_t>(mapping[cell])].push_back(static_cast<int>(cell));
  return cells;
}

ChannelCells
plain_cells(int rows, int columns, int channels)
{
  ChannelCells cells(static_cast<std::size_t>(channels));
  for (int channel = 0; channel < channels; channel++)
    if (channels < rows * columns)
      cells[static_cast<std::size_t>(channel)] = side_by_side(rows, columns, channel, channels);
    else if (channel < rows * columns)
      cells[static_cast<std::size_t>(channel)] = { channel };
  return cells;
}

ChannelCells
placed_cells(int rows, int columns, std::span<const Place> places)
{
  ChannelCells cells(places.size());
  const bool only_front = std::ranges::all_of(
      places, [](Place place) { return is_front(place) || place == Place::other; });
  std::vector<std::size_t> from_left;
  for (std::size_t i = 0; i < places.size(); i++) {
    if (places[i] == Place::low) {
      cells[i].resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns));
      std::iota(cells[i].begin(), cells[i].end(), 0);
    } else if (places[i] != Place::other && is_front(places[i]) == only_front) {
      from_left.push_back(i);
    }
  }
  std::ranges::stable_sort(from_left, {}, [&](std::size_t i) { return places[i]; });
  for (std::size_t i = 0; i < from_left.size(); i++)
    cells[from_left[i]]
        = side_by_side(rows, columns, static_cast<int>(i), static_cast<int>(from_left.size()));
  return cells;
}

void
pool(const ChannelCells &cells, std::span<const float> levels, std::span<float> pooled)
{
  for (std::size_t channel = 0; channel < cells.size(); channel++) {
    pooled[channel] = 0;
    for (const int cell : cells[channel])
      if (static_cast<std::size_t>(cell) < levels.size())
        pooled[channel] = std::max(pooled[channel], levels[static_cast<std::size_t>(cell)]);
  }
}

} // namespace synth
