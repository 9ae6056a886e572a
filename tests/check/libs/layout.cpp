// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/layout.h"

#include <cmath>
#include <vector>

#include "support/check_tests.h"

using namespace tactor;

namespace {

using Levels = std::vector<float>;

Levels
pooled(const Levels &levels, int rows, int columns, const Layout &layout)
{
  Levels out;
  pool(levels, rows, columns, layout, out);
  return out;
}

constexpr Layout kVest{ .rows = 5, .columns = 4 };

} // namespace

CHECK_TEST(test_finer_maps)
{
  const Layout grips{ .rows = 1, .columns = 2 };
  fail_unless(pooled({ .1F, .2F, .3F, .4F, .8F, .7F, .6F, .5F }, 2, 4, grips)
              == (Levels{ .8F, .6F }));
  // The column that is left over goes to the left.
  fail_unless(pooled({ 0, .5F, .2F }, 1, 3, grips) == (Levels{ .5F, .2F }));
  fail_unless(pools(grips, 1, 3) && pools(grips, 2, 2) && !pools(grips, 1, 2));
  fail_unless(pooled({ .1F, NAN, .3F }, 1, 3, grips) == (Levels{ .1F, .3F }));
}

CHECK_TEST(test_coarser_maps)
{
  fail_unless(pooled({ .5F }, 1, 1, { .rows = 1, .columns = 2 }) == (Levels{ .5F, .5F }));
  fail_if(pools(kVest, 3, 3));
  // Of five rows the third one's two neighbors go to the first and second row of the map.
  const Levels vest = pooled({ .1F, .2F, .3F, .4F, .5F, .6F, .7F, .8F, .9F }, 3, 3, kVest);
  const Levels expected{ .1F, .1F, .2F, .3F, .1F, .1F, .2F, .3F, .4F, .4F,
                         .5F, .6F, .4F, .4F, .5F, .6F, .7F, .7F, .8F, .9F };
  fail_unless(vest == expected);
}

/// Each panel has the whole map.
CHECK_TEST(test_panels)
{
  const Layout sides{ .rows = 1, .columns = 2, .panels = 2 };
  ck_assert_int_eq(sides.tactors(), 4);
  fail_unless(pooled({ .1F, .2F }, 1, 2, sides) == (Levels{ .1F, .2F, .1F, .2F }));
}

/// A single cell is felt on every layout, wherever it is.
CHECK_TEST(test_no_cell_is_dropped)
{
  for (const Layout &layout : { kVest, Layout{ 1, 2 }, Layout{ 1, 1 }, Layout{ 2, 6 } })
    for (int rows = 1; rows <= 8; rows++)
      for (int columns = 1; columns <= 8; columns++)
        for (int cell = 0; cell < rows * columns; cell++) {
          Levels map(static_cast<std::size_t>(rows * columns));
          map[static_cast<std::size_t>(cell)] = 1;
          float sum = 0;
          for (const float level : pooled(map, rows, columns, layout))
            sum += level;
          fail_unless(sum >= 1, "cell %d of %d x %d", cell, rows, columns);
        }
}

CHECK_MAIN(layout)
