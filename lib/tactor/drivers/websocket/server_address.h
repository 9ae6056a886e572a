// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/driver_error.h"

#include <tl/expected.hpp>

#include <string>

namespace tactor {

/// The form of DriverConfig::device for a device behind a server: "NAME", "NAME@HOST" or
/// "NAME@HOST:PORT", each part by default that of the server's own.
struct ServedName
{
  std::string name;
  std::string address; ///< "HOST:PORT"
};

/// The error (settings) says what was expected. The last "@" counts, a name may have others.
tl::expected<ServedName, DriverError> read_served_name(const std::string &device, int default_port);

} // namespace tactor
