// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "support/boards/emulated_board.h"

#include <algorithm>
#include <array>
#include <memory>

namespace usb_test {

/// A Mega with nine motors.
struct Chair
{
  static constexpr std::array kPins{ 2, 3, 4, 5, 6, 7, 8, 9, 10 };
  static constexpr int kDuty = 190; ///< of 255: level 0.747, as of Launch

  explicit Chair(bool seat = false, Transport transport = Transport::cdc_acm)
      : firmware(std::make_shared<Firmware>(kMega, seat)),
        board(usb, { .transport = transport, .baud = 57600, .chip = 128 }, firmware)
  {
  }

  /// After the soft start.
  bool wait_for_motors()
  {
    return board.wait_until([&] {
      return std::ranges::all_of(kPins, [&](int pin) { return firmware->duty(pin) == kDuty; });
    });
  }
  bool wait_for_zero()
  {
    return board.wait_until([&] { return !firmware->any_motor_on(); });
  }
  bool any_motor_on() const
  {
    bool is_on = false;
    board.with_firmware([&] { is_on = firmware->any_motor_on(); });
    return is_on;
  }
  /// The last bytes: a reset, and a query whose answer confirms that it was read.
  bool was_told_to_stand() const
  {
    const Bytes told = board.bytes();
    return told.size() >= 2 && told[told.size() - 2] == 0xff && told.back() == 0xf9;
  }
  /// The kernel took the board back from a process that has ended.
  bool wait_for_hosts_end()
  {
    return board.wait_until([&] { return board.hosts() == 0; });
  }
  /// The kernel's driver has the board again, last of all.
  bool wait_for_return()
  {
    return board.wait_until([&] { return board.hosts() == 0 && board.is_returned(); });
  }

  EmulatedUsb usb;
  std::shared_ptr<Firmware> firmware;
  EmulatedBoard board;
};

} // namespace usb_test
