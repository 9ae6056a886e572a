// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <string_view>

namespace tactor {

/// What a device says of itself, fit to be printed: valid UTF-8 of at most 126 characters (the
/// longest string descriptor, USB 2.0, 9.6.7) without control characters; each byte or character
/// that is not fit becomes U+FFFD. Without white space at both ends.
std::string legible(std::string_view text);

} // namespace tactor
