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
/// All of them, with commas between.
std::string describe(const std::vector<SerialDevice> &devices);

/// What of all that is plugged in may be asked whether it is a tactor board.
struct BoardChoice
{
  std::vector<SerialDevice> wanted;      ///< in the order in which they are to be asked
  std::vector<SerialDevice> passed_over; ///< adapters that may be anything
};

/// `name`: a serial number or a bus path; where it is empty, makers' boards come first, then
/// adapters behind which a board has answered before, then, only if `asks_strangers`, other
/// adapters; of each kind in the bus's order.
BoardChoice choose_boards(const std::vector<SerialDevice> &all, const std::string &name,
                          bool asks_strangers, const KnownBoards &known);

/// What an open board is known by if it goes away.
///
/// A socket that was named means that socket, and whatever board is in it. Otherwise it is the same
/// board: the same serial number, in the same socket or another; but without a number, or where
/// others have the same, only what is in the same socket can be told to be it.
class BoardIdentity
{
public:
  /// `name` as for choose_boards(); `all` that are plugged in.
  BoardIdentity(SerialDevice board, const std::string &name, const std::vector<SerialDevice> &all);

  /// Looks for others with the same number.
  void look_at(const std::vector<SerialDevice> &all);
  /// It was found, maybe in another socket.
  void is_now(SerialDevice board);
  /// Nothing but its socket tells it from others.
  bool is_of_its_socket() const
  {
    return is_of_its_socket_;
  }
  /// It, or what is taken for it, if it is plugged in.
  std::optional<SerialDevice> find(const std::vector<SerialDevice> &all) const;

private:
  bool is_same(const SerialDevice &other) const;

  SerialDevice board_;
  bool any_in_socket_;
  bool is_of_its_socket_;
};

} // namespace tactor
