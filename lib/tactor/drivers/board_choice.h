// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/drivers/known_boards.h"
#include "tactor/serial/serial_port.h"

#include <optional>
#include <string>
#include <vector>

namespace tactor {

/// "Arduino Mega 2560 (serial 7573, at 1-2)", in printable ASCII.
std::string describe(const SerialDevice &device);
/// Separated by commas.
std::string describe(const std::vector<SerialDevice> &devices);

/// The devices to probe for tactor boards.
struct BoardChoice
{
  std::vector<SerialDevice> wanted;        ///< to probe first, in this order
  std::optional<SerialDevice> stranger;    ///< to probe without a reset, if none was wanted
  std::vector<SerialDevice> passed_over{}; ///< skipped: each may be anything
  bool may_lack_one = false; ///< a skipped device was never probed: it may be the board
};

/// `name` is a serial number or a bus path, whose devices are wanted. If it is empty, those are
/// wanted that are known to be tactor boards, in the bus's order. If none is there and
/// `asks_a_stranger`, the only device that has not failed a probe is the `stranger`.
BoardChoice choose_boards(const std::vector<SerialDevice> &all, const std::string &name,
                          bool asks_a_stranger, const KnownBoards &known);

/// Recognizes an open board after it was lost.
///
/// If a socket was named, any board in it is taken. Otherwise the serial number has to be the same,
/// in any socket. A board without a number, or with one that others have, is recognized by its
/// socket.
class BoardIdentity
{
public:
  /// `name` as for choose_boards(); `all` are the devices plugged in.
  BoardIdentity(SerialDevice board, const std::string &name, const std::vector<SerialDevice> &all);

  /// Checks whether others have the same number.
  void look_at(const std::vector<SerialDevice> &all);
  /// The board was found, maybe in another socket.
  void is_now(SerialDevice board);
  /// Whether it is recognized by its socket alone.
  bool is_of_its_socket() const
  {
    return is_of_its_socket_;
  }
  /// The device recognized as the board, if there is one.
  std::optional<SerialDevice> find(const std::vector<SerialDevice> &all) const;

private:
  bool is_same(const SerialDevice &other) const;

  SerialDevice board_;
  bool any_in_socket_;
  bool is_of_its_socket_;
};

} // namespace tactor
