// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/driver_error.h"
#include "tactor/drivers/conversation.h"
#include "tactor/drivers/message_socket.h"

#include <tl/expected.hpp>

#include <functional>
#include <memory>
#include <string>

namespace tactor {

/// A program that drives devices, and the connection to it.
struct Server
{
  std::string name; ///< for messages: "Intiface at 127.0.0.1:12345"
  std::string page; ///< of the documentation
  std::unique_ptr<Conversation> conversation{};
  std::function<std::unique_ptr<MessageSocket>()> connect{};
};

/// Finds the server for a DriverConfig::device, which may end with "@HOST" or "@HOST:PORT".
using MakeServer = std::function<tl::expected<Server, DriverError>(const std::string &device)>;

/// Servers by WebSocket and JSON, in a module that these calls load, as it needs large libraries: a
/// process that plays on a board does not load it. The module is searched in $VISUOTACTILE_MODULES,
/// by default where it is installed.
tl::expected<Server, DriverError> make_bhaptics_server(const std::string &device);
tl::expected<Server, DriverError> make_intiface_server(const std::string &device);

} // namespace tactor
