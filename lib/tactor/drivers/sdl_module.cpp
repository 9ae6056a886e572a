// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/gamepads.h"

#include <gmodule.h>

namespace tactor {

tl::expected<std::unique_ptr<Gamepads>, DriverError>
make_sdl_gamepads()
{
  const char *set = g_getenv("VISUOTACTILE_MODULES");
  const std::string file = std::string(set != nullptr ? set : MODULES) + "/visuotactile-gamepad.so";
  GModule *opened = g_module_open(file.c_str(), G_MODULE_BIND_LOCAL);
  gpointer symbol = nullptr;
  if (opened == nullptr || !g_module_symbol(opened, "visuotactile_make_gamepads", &symbol))
    return tl::unexpected(
        DriverError{ DriverError::Kind::not_found,
                     "the module for gamepads cannot be loaded: " + std::string(g_module_error())
                         + "; install gstreamer1.0-visuotactile-gamepad, or take another driver" });
  g_module_make_resident(opened); // gamepads have their code in it
  const auto make = reinterpret_cast<Gamepads *(*)(std::string &)>(symbol);
  std::string why;
  std::unique_ptr<Gamepads> gamepads(make(why));
  if (!gamepads)
    return tl::unexpected(
        DriverError{ DriverError::Kind::failed,
                     "SDL cannot list gamepads: " + why + "; see docs/hardware/gamepad.md" });
  return gamepads;
}

} // namespace tactor
