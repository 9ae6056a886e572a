// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "follow/players/player.h"

#include <gio/gio.h>

#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace follow {

/// An open connection to a player: calls back on the thread of the main context in which it was
/// made. It must not be destroyed meanwhile.
class PlayerSocket
{
public:
  struct Events
  {
    /// Received bytes, and their local time. False: no more bytes are wanted.
    std::function<bool(std::string_view bytes, Time now)> received;
    std::function<void(const std::string &why)> gone; ///< once; nothing follows
  };

  /// Takes a reference. The socket does not block from now on.
  PlayerSocket(GSocket *socket, Events events);
  ~PlayerSocket();
  PlayerSocket(const PlayerSocket &) = delete;
  PlayerSocket &operator=(const PlayerSocket &) = delete;

  /// An error, if not all could be sent at once.
  std::string send(std::string_view bytes);

  /// Whether the player sends so many messages that they would keep this thread busy. Call it for
  /// each message.
  bool is_flood(Time now);
  static std::string flood();

private:
  gboolean on_readable();
  gboolean gone(const std::string &why);

  const Events events_;
  GSocket *socket_;
  GSource *source_;
  Time counted_from_{ 0 };
  int counted_ = 0;
};

} // namespace follow
