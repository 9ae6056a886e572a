// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/release_boards.h"

#include "tactor/drivers/firmata_driver.h"

#include <utility>

namespace tactor {

tl::expected<std::vector<ReleasedBoard>, DriverError>
release_boards(const MakeSerialBus &make_bus, FirmataPatience patience)
{
  tl::expected<std::unique_ptr<SerialBus>, DriverError> bus = make_bus();
  if (!bus)
    return tl::unexpected(bus.error());
  tl::expected<std::vector<SerialDevice>, DriverError> devices = (*bus)->list();
  if (!devices)
    return tl::unexpected(devices.error());
  std::vector<ReleasedBoard> released;
  for (SerialDevice &device : *devices) {
    if (!(*bus)->is_left(device))
      continue;
    FirmataDriver driver(FirmataDriver::Firmware::any, make_bus, { .patience = patience });
    // Any firmware: closing releases the board.
    const tl::expected<void, DriverError> opened = driver.open({ .device = device.bus_path });
    driver.close();
    released.push_back(
        { std::move(device), opened ? std::nullopt : std::optional(opened.error()) });
  }
  return released;
}

} // namespace tactor
