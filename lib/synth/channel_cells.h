// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

namespace synth {

/// Where a channel's loudspeaker is. Shakers are on those behind and below, if there are any.
enum class Place
{
  front_left,
  front_center,
  front_right,
  side_left,
  back_left,
  back_center,
  back_right,
  side_right,
  low, ///< LFE: bass
  other,
};

/// The cells of a map that each channel plays, the strongest of them: row by row from 0.
using ChannelCells = std::vector<std::vector<int>>;

/// Cell i is channel mapping[i], or none where that is negative or beyond the channels.
ChannelCells mapped_cells(std::span<const int> mapping, int channels);

/// Cell i is channel i if there are that many channels without places. Otherwise channels stand
/// side by side, and each plays the columns at its place: one in the middle is on both. Channels
/// with places play if they are behind, at the sides or `low`; channels in front play if there are
/// no others. `low` plays all cells, and `other` none. A channel without cells is silent.
ChannelCells placed_cells(int rows, int columns, std::span<const Place> places);
/// As placed_cells(), of channels without places.
ChannelCells plain_cells(int rows, int columns, int channels);

/// The strongest level of each channel's cells.
void pool(const ChannelCells &cells, std::span<const float> levels, std::span<float> pooled);

} // namespace synth
