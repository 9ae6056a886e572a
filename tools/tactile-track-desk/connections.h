// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <libsoup/soup.h>

#include <map>

/// The socket on 127.0.0.1, and until when the request of each connection has to be there. Those
/// that are late, and those above a number, are ended. Of the main context's thread.
class Connections
{
public:
  static constexpr std::size_t kMost = 64;
  static constexpr gint64 kRequest = 30 * G_USEC_PER_SEC; ///< for a request to arrive

  /// `port` 0: `usual` if it is free, else any. Throws std::runtime_error.
  Connections(SoupServer *server, guint16 port, guint16 usual);
  ~Connections();
  Connections(const Connections &) = delete;
  Connections &operator=(const Connections &) = delete;

  guint16 port() const
  {
    return port_;
  }

private:
  void set_deadline(SoupServerMessage *message, gint64 span);
  void close_late();
  static void gone(gpointer self, GObject *socket);

  SoupServer *server_;
  guint16 port_ = 0;
  std::map<GSocket *, gint64> deadlines_; ///< of those that are there
  guint tick_ = 0;
};
