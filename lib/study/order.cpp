// SPDX-License-Identifier: LGPL-2.1-or-later
#include "study/order.h"

#include <algorithm>

namespace study {

namespace {

/// Counts how often each condition had each position, and followed each other one.
class Balance
{
public:
  explicit Balance(std::size_t count)
      : count_(count), positions_(count * count), successions_(count * count)
  {
  }

  void add(const Row &row)
  {
    for (std::size_t i = 0; i < row.size(); i++) {
      positions_[i * count_ + row[i]]++;
      if (i > 0)
        successions_[row[i - 1] * count_ + row[i]]++;
    }
  }

  /// The sum of squares with this row added: the smaller, the more even.
  std::size_t unevenness(const Row &row) const
  {
    Balance with = *this;
    with.add(row);
    std::size_t sum = 0;
    for (const auto *counts : { &with.positions_, &with.successions_ })
      for (const std::size_t n : *counts)
        sum += n * n;
    return sum;
  }

private:
  std::size_t count_;
  std::vector<std::size_t> positions_;
  std::vector<std::size_t> successions_;
};

} // namespace

std::vector<Row>
williams_square(std::size_t count)
{
  Row first; // 0, 1, n − 1, 2, n − 2, …: its steps are all different
  for (std::size_t i = 0; i < count; i++)
    first.push_back(i % 2 == 1 ? (i + 1) / 2 : (count - i / 2) % count);
  std::vector<Row> rows;
  for (std::size_t i = 0; i < count; i++) {
    Row &row = rows.emplace_back(first);
    for (std::size_t &condition : row)
      condition = (condition + i) % count;
  }
  for (std::size_t i = 0; count > 1 && count % 2 == 1 && i < count; i++)
    rows.emplace_back(rows[i].rbegin(), rows[i].rend());
  return rows;
}

Place
next_place(std::size_t groups, const std::vector<Row> &square, const std::vector<GivenPlace> &given)
{
  std::vector<std::size_t> sizes(groups);
  std::vector<std::vector<int>> taken(groups, std::vector<int>(square.size()));
  std::vector<std::vector<int>> freed = taken;
  for (const auto &[place, is_free] : given) {
    if (place.group >= groups || place.row >= square.size())
      continue; // of another study
    sizes[place.group] += is_free ? 0 : 1;
    taken[place.group][place.row] += is_free ? 0 : 1;
    freed[place.group][place.row] += is_free ? 1 : 0;
  }
  const auto group = static_cast<std::size_t>(std::ranges::min_element(sizes) - sizes.begin());
  const std::vector<int> &uses = taken[group];
  const int least = *std::ranges::min_element(uses);
  Balance balance(square.front().size());
  for (std::size_t i = 0; i < square.size(); i++)
    for (int n = least; n < uses[i]; n++) // rows of the incomplete square
      balance.add(square[i]);
  std::size_t best = square.size();
  for (std::size_t i = 0; i < square.size(); i++) {
    if (uses[i] > least)
      continue;
    if (freed[group][i] > 0)
      return { .group = group, .row = i };
    if (best == square.size() || balance.unevenness(square[i]) < balance.unevenness(square[best]))
      best = i;
  }
  return { .group = group, .row = best };
}

} // namespace study
