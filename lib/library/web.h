// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gio/gio.h>

#include <cstddef>
#include <string>

#include <tl/expected.hpp>

namespace library {

/// How long an answer may take, whatever the server sends meanwhile.
inline constexpr guint kPatience = 20; // s

/// Whether this is the address of a server.
bool is_address(const std::string &where);

/// The body of an answer, of at most `most` bytes, to a GET request without cookies, credentials or
/// the name of this program. Redirects are not followed. Waits up to kPatience; any thread may
/// cancel. The error says what was expected, what came and what to do. Loads libsoup.
tl::expected<std::string, std::string> fetch(const std::string &address, std::size_t most,
                                             GCancellable *stop = nullptr);

/// The module's function "visuotactile_fetch": the body, else false and the error.
using Fetch = bool(const std::string &address, std::size_t most, GCancellable *stop,
                   std::string &body, std::string &error);

} // namespace library
