// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "follow/players/json_stream.h"
#include "follow/players/player.h"

#include <gio/gio.h>

#include <functional>
#include <memory>
#include <string>

namespace follow {

inline constexpr guint16 kKodiPort = 9090;

/// Kodi at the other end of an open connection. Its position is queried while it plays.
std::unique_ptr<Player> open_kodi(GSocketConnection *connection, PlayerEvents events);

/// Probes whether Kodi runs, without waiting for it. Calls back in the main context in which it was
/// made.
class KodiSearch
{
public:
  struct Events
  {
    std::function<void(GSocketConnection *)> found;
    /// `is_other`: another program answers at the port.
    std::function<void(const std::string &why, bool is_other)> missed;
  };

  /// `address`: HOST[:PORT].
  KodiSearch(std::string address, Events events);
  ~KodiSearch();
  KodiSearch(const KodiSearch &) = delete;
  KodiSearch &operator=(const KodiSearch &) = delete;

  /// Probes now, unless a probe is in progress.
  void look();

private:
  static void on_connected(GObject *client, GAsyncResult *result, gpointer data);
  static void on_read(GObject *stream, GAsyncResult *result, gpointer data);
  void read_on();
  void miss(const std::string &why, bool is_other);

  const std::string address_;
  const Events events_;
  GCancellable *canceled_;
  bool looks_ = false;
  GSocketConnection *connection_ = nullptr; ///< until the answer
  JsonStream objects_;
  std::size_t count_ = 0; ///< bytes read
};

} // namespace follow
