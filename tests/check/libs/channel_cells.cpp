// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synth/channel_cells.h"

#include "support/tolerance.h"

#include <array>

#include "support/check_tests.h"

using namespace synth;

CHECK_TEST(test_a_channel_for_each_cell)
{
  fail_unless((plain_cells(2, 2, 4) == ChannelCells{ { 0 }, { 1 }, { 2 }, { 3 } }));
  fail_unless((plain_cells(1, 2, 4) == ChannelCells{ { 0 }, { 1 }, {}, {} }));
  fail_unless((plain_cells(1, 1, 1) == ChannelCells{ { 0 } }));
}

CHECK_TEST(test_side_by_side)
{
  // 0 1 2
  // 3 4 5
  fail_unless((plain_cells(2, 3, 1) == ChannelCells{ { 0, 1, 2, 3, 4, 5 } }));
  fail_unless((plain_cells(2, 3, 2) == ChannelCells{ { 0, 1, 3, 4 }, { 1, 2, 4, 5 } }));
  fail_unless((plain_cells(2, 3, 3) == ChannelCells{ { 0, 3 }, { 1, 4 }, { 2, 5 } }));
  fail_unless(
      (plain_cells(2, 3, 4) == ChannelCells{ { 0, 3 }, { 0, 1, 3, 4 }, { 1, 2, 4, 5 }, { 2, 5 } }));
  // No cell is dropped and no channel is without one, whatever the numbers.
  for (const int columns : { 1, 2, 3, 4, 7, 16, 33, 64 })
    for (int channels = 1; channels < 64 && channels < 3 * columns; channels++) {
      std::vector<int> felt(static_cast<std::size_t>(3 * columns));
      for (const std::vector<int> &cells : plain_cells(3, columns, channels)) {
        fail_if(cells.empty());
        for (const int cell : cells)
          felt.at(static_cast<std::size_t>(cell))++;
      }
      for (const int times : felt)
        fail_if(times == 0);
    }
}

CHECK_TEST(test_places)
{
  using enum Place;
  const std::vector<int> all = { 0, 1, 2, 3, 4, 5 };
  const std::vector<int> left = { 0, 1, 3, 4 };
  const std::vector<int> right = { 1, 2, 4, 5 };
  const std::vector<int> none;
  const auto cells = [](std::vector<Place> places) {
    return placed_cells(2, 3, places);
  };
  fail_unless((cells({ front_left, front_right }) == ChannelCells{ left, right }));
  fail_unless((cells({ front_right, front_left }) == ChannelCells{ right, left }));
  fail_unless((cells({ front_center }) == ChannelCells{ all }));
  // DualSense
  fail_unless((cells({ front_left, front_right, back_left, back_right })
               == ChannelCells{ none, none, left, right }));
  // 5.1
  fail_unless((cells({ front_left, front_right, front_center, low, back_left, back_right })
               == ChannelCells{ none, none, none, all, left, right }));
  // 2.1
  fail_unless((cells({ front_left, front_right, low }) == ChannelCells{ none, none, all }));
  // 7.1: the sides are farther out than the back.
  fail_unless((cells({ front_left, front_right, front_center, low, back_left, back_right, side_left,
                       side_right })
               == ChannelCells{
                   none, none, none, all, { 0, 1, 3, 4 }, { 1, 2, 4, 5 }, { 0, 3 }, { 2, 5 } }));
  fail_unless((cells({ other, front_center }) == ChannelCells{ none, all }));
}

CHECK_TEST(test_mapping)
{
  fail_unless(
      (mapped_cells(std::array{ 1, -1, 0, 1, 7 }, 3) == ChannelCells{ { 2 }, { 0, 3 }, {} }));
}

CHECK_TEST(test_strongest_of_the_cells)
{
  std::array<float, 3> pooled{ 9, 9, 9 };
  pool({ { 0, 1 }, {}, { 2, 99 } }, std::array{ 0.25F, 0.75F, std::nanf("") }, pooled);
  fail_unless((pooled == std::array<float, 3>{ 0.75F, 0, 0 }));
}

CHECK_MAIN(channel_cells)
