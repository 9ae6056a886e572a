// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tl/expected.hpp>

#include <string>
#include <utility>

namespace tactor {

/// A process (tactor-guardian) that stops a board's motors when this one is gone: killed, crashed,
/// by exec() or _exit(). It holds the other end of a socket and waits for its end.
///
/// It is no child that the application could wait for: there is no SIGCHLD and no zombie. It has a
/// session of its own, so that nothing of the terminal reaches it, and inherits no file. A child
/// that the application forks without exec() keeps the socket open: the guardian then waits for the
/// child's end, too. Not thread-safe.
class Guardian
{
public:
  /// For the board at this bus path, which is open here. The error says in one line why there is no
  /// such process, as in a sandbox. $VISUOTACTILE_GUARDIAN is the program, else the installed one.
  [[nodiscard]] static tl::expected<Guardian, std::string> start(const std::string &bus_path);

  /// Has the guardian take over, unless it was dismissed.
  ~Guardian();
  Guardian(Guardian &&other) noexcept : socket_(std::exchange(other.socket_, -1))
  {
  }
  Guardian &operator=(Guardian &&other) noexcept
  {
    std::swap(socket_, other.socket_);
    return *this;
  }

  /// The motors are at zero: ends the guardian.
  void dismiss();

private:
  explicit Guardian(int socket) : socket_(socket)
  {
  }

  int socket_;
};

} // namespace tactor
