// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame/row_shares.h"

#include <algorithm>
#include <cstddef>

namespace saliency {

namespace {

constexpr int kAtATime = 4;

/// A band starts by reading rows above it for itself alone, so fewer rows are not worth stealing.
constexpr int kFewestToTake = 8;

} // namespace

void
RowShares::reset(int rows, int threads)
{
  left_.clear();
  const auto first = [rows, threads](int i) {
    return static_cast<int>(static_cast<long long>(rows) * i / threads);
  };
  for (int i = 0; i < threads; ++i)
    left_.push_back({ first(i), first(i + 1) });
}

RowShares::Rows
RowShares::take(int thread)
{
  const std::lock_guard lock(mutex_);
  const auto count = [](const Rows &rows) {
    return rows.end - rows.begin;
  };
  Rows &own = left_[static_cast<std::size_t>(thread)];
  if (count(own) == 0) {
    Rows &most = *std::ranges::max_element(left_, {}, count);
    if (count(most) >= kFewestToTake) {
      own = { most.begin + count(most) / 2, most.end };
      most.end = own.begin;
    }
  }
  const Rows taken{ own.begin, std::min(own.begin + kAtATime, own.end) };
  own.begin = taken.end;
  return taken;
}

} // namespace saliency
