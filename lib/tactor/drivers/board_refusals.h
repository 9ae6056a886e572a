// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/drivers/firmata_board.h"
#include "tactor/serial/serial_port.h"

#include <optional>
#include <set>
#include <string>
#include <vector>

namespace tactor {

/// "3, 5, 6"
std::string describe(const std::vector<int> &numbers);

/// Why a device is left to another program. `is_wanted`: the user says that it is a board, or that
/// there is one.
std::optional<DriverError> refusal_of_use(const SerialDevice &device, const LineUse &use,
                                          bool is_wanted);

/// Why a board that has answered does not fit: it has fewer than `needed` tactors, or no watchdog.
std::optional<DriverError> refusal_of_board(const SerialDevice &device, const FirmataBoard &board,
                                            int needed, bool needs_watchdog);

/// Why none of several boards was taken; at least one.
DriverError summary(const std::vector<DriverError> &refusals);

/// Why no board was probed: none of `devices` is the one with this name, or, if that is empty,
/// known to be one. `may_be_one`: one of them may be.
DriverError refusal_of_none(const std::string &name, const std::vector<SerialDevice> &devices,
                            bool may_be_one);

/// The remedy by which one of these devices is probed, for the end of a message. Empty if there is
/// none.
std::string advice(const std::vector<SerialDevice> &not_asked);

/// Why a board that is back is not used. Each reason is reported once.
class ReturnRefusals
{
public:
  /// The board is used, or gone again.
  void clear();

  /// Whether this one is to be reported. Most kinds only if they come twice in a row: udev may not
  /// be done, and the board may boot or be on its way out.
  bool add(const DriverError &refusal);

  /// Whether only another device can help. Each probe may reset the board.
  bool is_final() const;

private:
  static constexpr std::size_t kMost = 8; ///< reasons reported of one board

  std::optional<DriverError> last_;
  std::set<std::string> reported_;
};

} // namespace tactor
