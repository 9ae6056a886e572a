// SPDX-License-Identifier: LGPL-2.1-or-later
#include "modules/load_module.h"
#include "tactor/drivers/gamepads.h"

namespace tactor {

tl::expected<std::unique_ptr<Gamepads>, DriverError>
make_sdl_gamepads()
{
  const auto make = load_module<Gamepads *(std::string &)>("visuotactile-gamepad",
                                                           "visuotactile_make_gamepads", MODULES);
  if (!make)
    return tl::unexpected(
        DriverError{ DriverError::Kind::not_found,
                     "the module for gamepads cannot be loaded: " + make.error()
                         + "; install gstreamer1.0-visuotactile-gamepad, or take another driver" });
  std::string why;
  std::unique_ptr<Gamepads> gamepads((*make)(why));
  if (!gamepads)
    return tl::unexpected(
        DriverError{ DriverError::Kind::failed,
                     "SDL cannot list gamepads: " + why + "; see docs/hardware/gamepad.md" });
  return gamepads;
}

} // namespace tactor
