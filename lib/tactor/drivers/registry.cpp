// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/registry.h"

#include "tactor/drivers/auto_driver.h"
#include "tactor/drivers/firmata_driver.h"
#ifdef HAVE_GAMEPAD
#include "tactor/drivers/gamepad_driver.h"
#endif
#ifdef HAVE_WEBSOCKET
#include "tactor/drivers/server_driver.h"
#endif
#include "tactor/simulator.h"

namespace tactor {

const std::vector<DriverInfo> &
drivers()
{
  static const std::vector<DriverInfo> all{
    { "auto", "firmata if a board is there, else simulator",
      [] {
        return std::make_unique<AutoDriver>(
            std::make_unique<FirmataDriver>(FirmataDriver::Firmware::any),
            std::make_unique<Simulator>());
      } },
    { "firmata", "any board with StandardFirmata or another Firmata sketch, on USB",
      [] {
        return std::make_unique<FirmataDriver>(FirmataDriver::Firmware::any);
      } },
    { "seat", "a board with the seat firmware, whose watchdog stops the motors, on USB",
      [] {
        return std::make_unique<FirmataDriver>(FirmataDriver::Firmware::with_watchdog);
      } },
#ifdef HAVE_GAMEPAD
    { "gamepad", "the rumble motors of a gamepad, by cable or Bluetooth",
      [] { return std::make_unique<GamepadDriver>(); }, true },
#endif
#ifdef HAVE_WEBSOCKET
    { "bhaptics", "a vest, sleeves or visor of bHaptics, by bHaptics Player",
      [] { return std::make_unique<ServerDriver>(make_bhaptics_server); }, true },
    { "intiface", "a device that vibrates, by Intiface; never one that was not named",
      [] { return std::make_unique<ServerDriver>(make_intiface_server); }, true },
#endif
    { "simulator", "no hardware: predicts what each motor would do",
      [] {
        return std::make_unique<Simulator>();
      } },
  };
  return all;
}

tl::expected<std::unique_ptr<Driver>, DriverError>
make_driver(std::string_view name)
{
  std::string known;
  for (const DriverInfo &driver : drivers()) {
    if (driver.name == name)
      return driver.create();
    known += (known.empty() ? "" : ", ") + std::string(driver.name);
  }
  return tl::unexpected(
      DriverError{ DriverError::Kind::not_found,
                   "no driver \"" + std::string(name) + "\"; known drivers: " + known });
}

} // namespace tactor
