// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/drivers/message_socket.h"

#include <memory>
#include <string>

namespace tactor {

/// A larger message ends the connection.
inline constexpr std::size_t kLargestMessage = std::size_t{ 1 } << 20;

/// A WebSocket by libsoup, without proxies, redirections and compression. `uri` as in
/// "ws://127.0.0.1:12345/".
std::unique_ptr<MessageSocket> open_soup_socket(const std::string &uri);

} // namespace tactor
