// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactile/orientation.h"

#include <vector>

#include "support/check_tests.h"

using tactile::Orientation;
using tactile::TactileMap;

namespace {

TactileMap
map_of(int rows, int columns, const std::vector<float> &levels)
{
  TactileMap map(rows, columns);
  map.levels = levels;
  return map;
}

TactileMap
turned(const TactileMap &stored, Orientation orientation)
{
  TactileMap shown;
  tactile::turn(stored, orientation, shown);
  return shown;
}

constexpr Orientation kClockwise{ .transposed = true,
                                  .mirrored_rows = true,
                                  .mirrored_columns = false };

} // namespace

CHECK_TEST(test_by_hand)
{
  const TactileMap stored = map_of(2, 3, { 1, 2, 3, 4, 5, 6 });
  fail_unless(turned(stored, {}) == stored);
  fail_unless(turned(stored, kClockwise) == map_of(3, 2, { 4, 1, 5, 2, 6, 3 }));
  fail_unless(
      turned(stored, { .transposed = true, .mirrored_rows = false, .mirrored_columns = true })
      == map_of(3, 2, { 3, 6, 2, 5, 1, 4 }));
  fail_unless(
      turned(stored, { .transposed = false, .mirrored_rows = true, .mirrored_columns = true })
      == map_of(2, 3, { 6, 5, 4, 3, 2, 1 }));
  fail_unless(
      turned(stored, { .transposed = true, .mirrored_rows = false, .mirrored_columns = false })
      == map_of(3, 2, { 1, 4, 2, 5, 3, 6 }));
  TactileMap map = stored;
  for (int quarter = 0; quarter < 4; quarter++)
    map = turned(map, kClockwise);
  fail_unless(map == stored);
}

CHECK_TEST(test_turn_back)
{
  const TactileMap stored = map_of(2, 3, { 1, 2, 3, 4, 5, 6 });
  for (int bits = 0; bits < 8; bits++) {
    const Orientation orientation{ .transposed = (bits & 1) != 0,
                                   .mirrored_rows = (bits & 2) != 0,
                                   .mirrored_columns = (bits & 4) != 0 };
    TactileMap back;
    tactile::turn_back(turned(stored, orientation), orientation, back);
    fail_unless(back == stored, "%d", bits);
  }
}

CHECK_MAIN(orientation)
