// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/line_time.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>

namespace tactor {

LineTime::LineTime(std::vector<int> bytes, Time byte) : bytes_(std::move(bytes)), byte_(byte)
{
}

int
LineTime::bytes(std::span<const std::size_t> tactors, std::size_t most) const
{
  std::vector<int> each;
  for (const std::size_t tactor : tactors)
    each.push_back(tactor < bytes_.size() ? bytes_[tactor] : 0);
  std::ranges::sort(each, std::greater{});
  each.resize(std::min(each.size(), most));
  return std::accumulate(each.begin(), each.end(), 0);
}

Time
LineTime::of(std::span<const std::size_t> tactors, std::size_t most) const
{
  return bytes(tactors, most) * byte_;
}

Time
LineTime::of(std::size_t tactor) const
{
  return bytes(std::span(&tactor, 1)) * byte_;
}

Time
LineTime::all() const
{
  return std::accumulate(bytes_.begin(), bytes_.end(), 0) * byte_;
}

} // namespace tactor
