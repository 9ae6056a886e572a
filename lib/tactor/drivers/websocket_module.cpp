// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/server.h"

#include <gmodule.h>

namespace tactor {

namespace {

tl::expected<Server, DriverError>
make_server(const char *maker, const std::string &device)
{
  const char *set = g_getenv("VISUOTACTILE_MODULES");
  const std::string file
      = std::string(set != nullptr ? set : MODULES) + "/visuotactile-websocket.so";
  GModule *opened = g_module_open(file.c_str(), G_MODULE_BIND_LOCAL);
  gpointer symbol = nullptr;
  if (opened == nullptr || !g_module_symbol(opened, maker, &symbol))
    return tl::unexpected(DriverError{
        DriverError::Kind::not_found,
        "the module for WebSockets cannot be loaded: " + std::string(g_module_error())
            + "; install gstreamer1.0-visuotactile-websocket, or take another driver" });
  g_module_make_resident(opened); // servers have their code in it
  Server server;
  DriverError error;
  const auto make
      = reinterpret_cast<bool (*)(const std::string &, Server &, DriverError &)>(symbol);
  if (!make(device, server, error))
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
