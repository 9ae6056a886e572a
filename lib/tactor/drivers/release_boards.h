// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/drivers/firmata_driver.h"

#include <optional>
#include <string>
#include <vector>

namespace tactor {

/// A board that a killed player held.
struct ReleasedBoard
{
  SerialDevice device;
  std::optional<DriverError> refusal{}; ///< why its motors could not be stopped
};

/// Opens, stops and releases each board that a process held when it was killed (SIGKILL, crash).
/// Such a board has no driver of the kernel's and thus no /dev/ttyACM0, and without a watchdog its
/// motors are still on. Devices without such a driver that are not known to be tactor boards are
/// not touched, unless their serial number or bus path is `name`. Takes up to
/// `settings.patience.answer` for a board that does not answer. Fails if the bus cannot be used.
[[nodiscard]] tl::expected<std::vector<ReleasedBoard>, DriverError>
release_boards(const std::string &name = "", const MakeSerialBus &make_bus = make_serial_bus,
               const FirmataDriver::Settings &settings = {});

} // namespace tactor
