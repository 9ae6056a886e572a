// SPDX-License-Identifier: LGPL-2.1-or-later
#include "known_driver.h"

#include "command_line.h"

#include "tactor/drivers/registry.h"

#include <string_view>
#include <vector>

void
expect_driver(const std::string &name, const std::string &another)
{
  std::vector<std::string_view> known;
  for (const tactor::DriverInfo &driver : tactor::drivers())
    known.push_back(driver.name);
  if (!another.empty())
    known.emplace_back(another);
  expect_one_of("--driver", name, known);
}
