// SPDX-License-Identifier: LGPL-2.1-or-later
#include "modules/load_module.h"
#include "tactor/drivers/server.h"

namespace tactor {

namespace {

tl::expected<Server, DriverError>
make_server(const char *maker, const std::string &device)
{
  const auto make = load_module<bool(const std::string &, Server &, DriverError &)>(
      "visuotactile-websocket", maker, MODULES);
  if (!make)
    return tl::unexpected(DriverError{
        DriverError::Kind::not_found,
        "the module for WebSockets cannot be loaded: " + make.error()
            + "; install gstreamer1.0-visuotactile-websocket, or take another driver" });
  Server server;
  DriverError error;
  if (!(*make)(device, server, error))
    return tl::unexpected(error);
  return server;
}

} // namespace

tl::expected<Server, DriverError>
make_bhaptics_server(const std::string &device)
{
  return make_server("visuotactile_make_bhaptics_server", device);
}

tl::expected<Server, DriverError>
make_intiface_server(const std::string &device)
{
  return make_server("visuotactile_make_intiface_server", device);
}

} // namespace tactor
