// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/drivers/firmata_board.h"
#include "tactor/serial/serial_port.h"

#include <optional>
#include <vector>

namespace tactor {

/// A board that a killed player had left.
struct ReleasedBoard
{
  SerialDevice device;
  std::optional<DriverError> refusal{}; ///< why its motors could not be stopped
};

/// After SIGKILL or a crash nobody has given a board back: the kernel has no driver for it, and so
/// no /dev/ttyACM0, and without a watchdog its motors are still on. Each such board is opened,
/// stopped and given back, which takes up to `patience.answer` where one does not answer.
/// DriverError where the bus cannot be used.
[[nodiscard]] tl::expected<std::vector<ReleasedBoard>, DriverError>
release_boards(const MakeSerialBus &make_bus = make_serial_bus, FirmataPatience patience = {});

} // namespace tactor
