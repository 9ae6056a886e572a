// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/driver.h"

#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

namespace tactor {

/// Reads which tactor each cell has, row by row, -1 for none: whole numbers from -1 to `tactors` -
/// 1 with commas between them, as in "2,1,0", with any white space; also as GStreamer writes
/// arrays, "<2, 1, 0>". Empty: a mapping of none, which leaves cell i to tactor i. What it cannot
/// read is told by number and with what was expected (DriverError::Kind::settings).
tl::expected<std::vector<int>, DriverError> read_mapping(std::string_view text, int tactors);

/// As above, "2,1,0".
std::string write_mapping(std::span<const int> mapping);

} // namespace tactor
