// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/drivers/firmata_board.h"
#include "tactor/serial/serial_port.h"

#include <optional>
#include <string>
#include <vector>

namespace tactor {

/// "3, 5, 6"
std::string describe(const std::vector<int> &numbers);

/// Why a device is to be left to another program; `is_wanted` by somebody who says that it is a
/// board, or that there is one.
std::optional<DriverError> refusal_of_use(const SerialDevice &device, const LineUse &use,
                                          bool is_wanted);

/// Why a board that has answered is not what is `needed`: so many tactors, and maybe the watchdog.
std::optional<DriverError> refusal_of_board(const SerialDevice &device, const FirmataBoard &board,
                                            int needed, bool needs_watchdog);

/// Why none of several boards was taken.
DriverError summary(const std::vector<DriverError> &refusals);

} // namespace tactor
