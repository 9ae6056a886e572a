// SPDX-License-Identifier: LGPL-2.1-or-later
#include "summary.h"

#include <algorithm>
#include <cmath>

namespace quality {

namespace {

std::string
cell(const SummaryRow &row, const Estimate &estimate)
{
  return row.share ? percent_text(estimate) : text(estimate, 2);
}

std::string
best_peer(const SummaryRow &row)
{
  const std::pair<std::string, Estimate> *best = nullptr;
  for (const auto &peer : row.peers) {
    if (std::isnan(peer.second.value))
      continue;
    if (!best
        || (row.higher ? peer.second.value > best->second.value
                       : peer.second.value < best->second.value))
      best = &peer;
  }
  return best ? cell(row, best->second) + " " + best->first : "–";
}

} // namespace

SummaryRow
summary_row(std::string set, std::string figure, const UnitsByModel &units)
{
  SummaryRow row{ .set = std::move(set), .figure = std::move(figure) };
  for (const auto &[model, means] : units)
    if (model == "tuned")
      row.ours = estimate(means);
    else if (model == "paper")
      row.paper = estimate(means);
    else
      row.peers.emplace_back(model, estimate(means));
  return row;
}

Table
summary_table(const Summary &summary)
{
  Table table("In short",
              "Means with 95 % intervals (bootstrap over pictures, films, or spans of labels). "
              "↑: more is better; ↓: less. The sections below say what is measured.",
              { "set", "figure", "ours", "literal paper", "best peer", "people" });
  for (const SummaryRow &row : summary)
    table.add({ row.set, row.figure + (row.higher ? " ↑" : " ↓"), cell(row, row.ours),
                cell(row, row.paper), best_peer(row), cell(row, row.people) });
  return table;
}

} // namespace quality
