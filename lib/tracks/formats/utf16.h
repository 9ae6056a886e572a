// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

namespace tactile {

/// A text in UTF-8. UTF-16, with a byte order mark or an ASCII character at the beginning, is
/// converted; invalid code units become U+FFFD. Any other text stays as it is.
std::string as_utf8(std::string text);

} // namespace tactile
