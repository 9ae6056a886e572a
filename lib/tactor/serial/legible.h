// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <string_view>

namespace tactor {

/// A device's string made printable: valid UTF-8 of at most 126 characters (the longest string
/// descriptor, USB 2.0, 9.6.7), without control characters and without white space at both ends.
/// Other bytes and characters become U+FFFD.
std::string legible(std::string_view text);

} // namespace tactor
