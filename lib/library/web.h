// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gio/gio.h>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

namespace library {

/// How long an answer may take, whatever the server sends meanwhile.
inline constexpr guint kPatience = 20; // s

/// Whether this is the address of a server.
bool is_address(const std::string &where);

/// A GET request.
struct Query
{
  std::string address;          ///< http://HOST/PATH or https://HOST/PATH
  std::size_t most;             ///< bytes of the answer
  GCancellable *stop = nullptr; ///< any thread may cancel
  std::vector<std::pair<std::string, std::string>> headers{}; ///< name, value
  std::string advice{}; ///< for the user, if the status of the answer is not 200
};

/// The body of the answer to a request without cookies, credentials or the name of this program.
/// Redirects are not followed. Waits up to kPatience. The error says what was expected, what came
/// and what to do. Loads libsoup.
tl::expected<std::string, std::string> fetch(const Query &query);

/// A file of a library of tracks.
tl::expected<std::string, std::string> fetch(const std::string &address, std::size_t most,
                                             GCancellable *stop = nullptr);

/// The module's function "visuotactile_fetch": the body, else false and the error.
using Fetch = bool(const Query &query, std::string &body, std::string &error);

} // namespace library
