// SPDX-License-Identifier: LGPL-2.1-or-later
#include "known_driver.h"

#include "command_line.h"

#include "tactor/drivers/registry.h"

void
expect_driver(const std::string &name, const std::string &another)
{
  std::string known;
  for (const tactor::DriverInfo &driver : tactor::drivers()) {
    if (driver.name == name)
      return;
    known += std::string(driver.name) + ", ";
  }
  known += another;
  if (another.empty())
    known.resize(known.size() - 2);
  if (another.empty() || name != another)
    throw UsageError("--driver is one of " + known + ", got '" + name + "'");
}
