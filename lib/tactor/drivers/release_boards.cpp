// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/release_boards.h"

#include <utility>

namespace tactor {

tl::expected<std::vector<ReleasedBoard>, DriverError>
release_boards(const std::string &name, const MakeSerialBus &make_bus,
               const FirmataDriver::Settings &settings)
{
  tl::expected<std::unique_ptr<SerialBus>, DriverError> bus = make_bus();
  if (!bus)
    return tl::unexpected(bus.error());
  tl::expected<std::vector<SerialDevice>, DriverError> devices = (*bus)->list();
  if (!devices)
    return tl::unexpected(devices.error());
  std::erase_if(*devices, [&](const SerialDevice &device) { return !(*bus)->is_left(device); });
  const BoardChoice choice
      = choose_boards(*devices, name, false, KnownBoards(settings.known_boards));
  std::vector<ReleasedBoard> released;
  for (const SerialDevice &device : choice.wanted) {
    FirmataDriver driver(FirmataDriver::Firmware::any, make_bus, settings);
    // Any firmware: closing releases the board.
    const tl::expected<void, DriverError> opened = driver.open({ .device = device.bus_path });
    driver.close();
    released.push_back({ device, opened ? std::nullopt : std::optional(opened.error()) });
  }
  for (const SerialDevice &device : choice.passed_over)
    released.push_back(
        { device, DriverError{ DriverError::Kind::not_asked,
                               "it is not known to be a tactor board; if it is one, add --device="
                                   + device.bus_path } });
  return released;
}

} // namespace tactor
