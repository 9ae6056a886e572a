// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The module that tactor::make_bhaptics_server() and make_intiface_server() load.
#include "tactor/drivers/server.h"
#include "tactor/drivers/websocket/bhaptics_conversation.h"
#include "tactor/drivers/websocket/buttplug_conversation.h"
#include "tactor/drivers/websocket/server_address.h"
#include "tactor/drivers/websocket/soup_socket.h"

#include <utility>

#define EXPORT extern "C" __attribute__((visibility("default")))

using namespace tactor;

namespace {

std::function<std::unique_ptr<MessageSocket>()>
connector(std::string uri)
{
  return [uri = std::move(uri)] {
    return open_soup_socket(uri);
  };
}

} // namespace

/// False if `device` cannot be read, with `error`.
EXPORT bool
visuotactile_make_bhaptics_server(const std::string &device, Server &server, DriverError &error)
{
  const tl::expected<ServedName, DriverError> named = read_served_name(device, bhaptics::kPort);
  const tl::expected<SuitPart, DriverError> part
      = named.and_then([](const ServedName &served) { return find_suit_part(served.name); });
  if (!part) {
    error = part.error();
    return false;
  }
  server.name = "bHaptics Player at " + named->address;
  server.page = "docs/hardware/vest.md";
  server.conversation = std::make_unique<BhapticsConversation>(server.name, *part);
  server.connect = connector("ws://" + named->address + std::string(bhaptics::kPath));
  return true;
}

EXPORT bool
visuotactile_make_intiface_server(const std::string &device, Server &server, DriverError &error)
{
  const tl::expected<ServedName, DriverError> named = read_served_name(device, buttplug::kPort);
  if (!named) {
    error = named.error();
    return false;
  }
  server.name = "Intiface at " + named->address;
  server.page = "docs/hardware/intiface.md";
  server.conversation = std::make_unique<ButtplugConversation>(server.name, named->name);
  server.connect = connector("ws://" + named->address + "/");
  return true;
}
