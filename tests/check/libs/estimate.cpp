// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cmath>
#include <vector>

#include "quality/estimate.h"
#include "support/tolerance.h"

#include "support/check_tests.h"

using quality::Estimate;
using quality::Mean;

CHECK_TEST(test_interval)
{
  // 100 coins: the standard error is 0.05, and 95 % are within 1.96 of them.
  std::vector<Mean> coins(100);
  for (std::size_t i = 0; i < coins.size(); ++i)
    coins[i].add(static_cast<double>(i % 2));
  const Estimate found = quality::estimate(coins);
  fail_unless_near(found.value, 0.5, 1e-12);
  fail_unless_near(found.low, 0.5 - 1.96 * 0.05, 0.015);
  fail_unless_near(found.high, 0.5 + 1.96 * 0.05, 0.015);

  // Values within a unit are not independent: the interval stays as wide.
  for (Mean &coin : coins)
    coin = { .sum = 10 * coin.sum, .count = 10 };
  const Estimate repeated = quality::estimate(coins);
  fail_unless_near(repeated.low, found.low, 1e-12);
  fail_unless_near(repeated.high, found.high, 1e-12);
}

CHECK_TEST(test_few_units)
{
  const std::vector<Mean> units{ {}, { .sum = 1, .count = 4 }, {} };
  const Estimate found = quality::estimate(units);
  fail_unless_near(found.value, 0.25, 1e-12);
  fail_unless(std::isnan(found.low) && std::isnan(found.high));
  fail_unless(std::isnan(quality::estimate({}).value));
  fail_unless(quality::percent_text(found) == "25.0 %");
  fail_unless(quality::text({ 1.25, 1, 1.5 }, 2) == "1.25 [1.00 1.50]");
  fail_unless(quality::text({}, 2) == "–");
}

CHECK_MAIN(estimate)
