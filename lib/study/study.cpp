// SPDX-License-Identifier: LGPL-2.1-or-later
#include "study/study.h"

#include "random.h"

#include <algorithm>
#include <numeric>

namespace study {

namespace {

/// All combinations; the first factor changes slowest.
std::vector<Condition>
combinations(const std::vector<Factor> &factors, bool between)
{
  std::vector<Condition> all(1);
  for (const Factor &factor : factors) {
    if (factor.between != between)
      continue;
    std::vector<Condition> next;
    for (const Condition &one : all)
      for (const Level &level : factor.levels) {
        Condition &with = next.emplace_back(one);
        with.levels[factor.name] = level.name;
        for (const auto &[name, value] : level.settings)
          with.settings[name] = value;
      }
    all = std::move(next);
  }
  return all;
}

} // namespace

const char *
name_of(Question::Kind kind)
{
  return kind == Question::Kind::slider   ? "slider"
         : kind == Question::Kind::likert ? "likert"
                                          : "text";
}

std::vector<Condition>
Study::conditions() const
{
  return combinations(factors, false);
}

std::vector<Condition>
Study::groups() const
{
  return combinations(factors, true);
}

std::vector<Row>
Study::square() const
{
  std::vector<Row> rows = williams_square(conditions().size());
  Row names(rows.front().size());
  std::iota(names.begin(), names.end(), 0);
  visuotactile::Random random(seed);
  for (std::size_t i = names.size(); i > 1; i--)
    std::swap(names[i - 1], names[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
  for (Row &row : rows)
    for (std::size_t &condition : row)
      condition = names[condition];
  return rows;
}

} // namespace study
