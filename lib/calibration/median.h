// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <vector>

namespace tactor {

/// The median; the mean of the middle two for an even number of values, 0 for none.
inline double
median(std::vector<double> values)
{
  if (values.empty())
    return 0;
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

} // namespace tactor
