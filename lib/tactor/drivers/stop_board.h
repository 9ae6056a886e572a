// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/serial/serial_port.h"

#include <chrono>
#include <string>

namespace tactor {

/// Timeouts of stop_board().
struct StopPatience
{
  std::chrono::milliseconds answer{ 250 }; ///< for the answer to a reset
  int tries = 2;                           ///< resets that may stay without an answer
};

/// Stops the motors of a board that is known to speak Firmata, and that its last host has left as
/// it was: by a reset, whose answer proves that the board has read it. The pins need not be known.
/// If none comes and `*may_pulse` is true, DTR is switched off and on, which resets most boards,
/// and `*may_pulse` becomes false. NULL: no DTR.
///
/// The error says why the motors may still be on. Blocks, for longer than the patience only where
/// requests of the setup are not answered. Any thread that may use the bus.
[[nodiscard]] tl::expected<void, DriverError> stop_board(SerialBus &bus, const SerialDevice &device,
                                                         bool *may_pulse,
                                                         const StopPatience &patience = {});

/// The remedy in the message about such an error.
std::string advice_after(const DriverError &not_stopped);

} // namespace tactor
