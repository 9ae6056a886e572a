// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/driver.h"

#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

namespace tactor {

/// Reads the tactor of each cell, row by row, -1 for none: integers below `tactors` with commas
/// between them, "2,1,0" or GStreamer's "<2, 1, 0>", with any white space. An empty mapping gives
/// cell i tactor i. The error (settings) names the entry and what was expected.
tl::expected<std::vector<int>, DriverError> read_mapping(std::string_view text, int tactors);

/// Writes "2,1,0".
std::string write_mapping(std::span<const int> mapping);

} // namespace tactor
