// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/driver.h"

#include <functional>
#include <memory>
#include <string_view>
#include <vector>

namespace tactor {

struct DriverInfo
{
  std::string_view name;        ///< as in `tactorsink driver=NAME`
  std::string_view description; ///< one line
  std::function<std::unique_ptr<Driver>()> create;
  /// Each tactor is a motor that has a name: DriverStatus::motors, of an open driver. A board has
  /// tactors to which nothing may be connected.
  bool names_motors = false;
};

/// All drivers of this build, the default one first.
const std::vector<DriverInfo> &drivers();

/// Makes a driver. The error (not_found) lists the known names.
[[nodiscard]] tl::expected<std::unique_ptr<Driver>, DriverError> make_driver(std::string_view name);

} // namespace tactor
