// SPDX-License-Identifier: LGPL-2.1-or-later
#include "modules/load_module.h"
#include "tactor/drivers/server.h"

#include <dlfcn.h>

namespace tactor {

namespace {

/// libsoup 2 has types of the same names as libsoup 3, with which the module is linked: a process
/// can only have one of them.
bool
has_libsoup_2()
{
  void *const library = dlopen("libsoup-2.4.so.1", RTLD_LAZY | RTLD_NOLOAD);
  if (library != nullptr)
    dlclose(library);
  return library != nullptr;
}

tl::expected<Server, DriverError>
make_server(const char *maker, const std::string &device)
{
  if (has_libsoup_2())
    return tl::unexpected(DriverError{
        DriverError::Kind::not_found,
        "the module for WebSockets needs libsoup 3, beside which this program's libsoup 2 cannot "
        "be; play in another program, or take another driver" });
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
