// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "estimate.h"
#include "table.h"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace quality {

/// A row of the table with which the page begins: one figure of one set of pictures or films.
struct SummaryRow
{
  std::string set;
  std::string figure;
  bool higher = true; ///< is better
  bool share = true;  ///< printed in percent
  Estimate ours{};
  Estimate paper{}; ///< the paper's profile
  Estimate people{};
  std::vector<std::pair<std::string, Estimate>> peers{}; ///< with their names
};

/// The units of one figure, by model.
using UnitsByModel = std::map<std::string, std::vector<Mean>>;

/// A row of shares, of the models "tuned", "paper", and peers by their names.
SummaryRow summary_row(std::string set, std::string figure, const UnitsByModel &units);

/// The rows in the order in which the tables are made.
using Summary = std::vector<SummaryRow>;

Table summary_table(const Summary &summary);

} // namespace quality
