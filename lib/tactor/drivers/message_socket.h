// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <string>

namespace tactor {

struct SocketEvent
{
  enum class Kind
  {
    none,    ///< the time is up, or wake() was called
    opened,  ///< once, before all others
    message, ///< from the server
    closed,  ///< closed or not opened; the last event
  };

  Kind kind = Kind::none;
  std::string text{}; ///< the message, or why the connection was closed
};

/// A connection that carries messages. It is opened from the beginning of its life. The destructor
/// closes it; what was sent goes out first, unless the server does not take it for a while. It is
/// of the thread that made it, but for wake().
class MessageSocket
{
public:
  virtual ~MessageSocket() = default;

  /// Does not wait. Ignored while the connection is not open. `text` is valid UTF-8.
  virtual void send(const std::string &text) = 0;

  /// The next event, by `until` of the steady clock at the latest.
  virtual SocketEvent wait(Time until) = 0;

  /// Ends the present or the next wait(). Any thread.
  virtual void wake() = 0;
};

} // namespace tactor
