// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <libsoup/soup.h>

#include <map>

/// The socket on 127.0.0.1, and until when the request of each connection has to be there. Those
/// that are late are ended. Above a number, the oldest that has not named the token is: others
/// cannot shut the page out. Of the main context's thread.
class Connections
{
public:
  static constexpr std::size_t kMost = 64;
  static constexpr gint64 kUnknown = 5 * G_USEC_PER_SEC;  ///< for a request to name the token
  static constexpr gint64 kRequest = 30 * G_USEC_PER_SEC; ///< for the rest of it to arrive

  /// `port` 0: `usual` if it is free, else any. Throws std::runtime_error.
  Connections(SoupServer *server, guint16 port, guint16 usual);
  ~Connections();
  Connections(const Connections &) = delete;
  Connections &operator=(const Connections &) = delete;

  /// Admits the connection of a request that has named the token.
  void admit(SoupServerMessage *message);

  guint16 port() const
  {
    return port_;
  }

private:
  struct Connection
  {
    gint64 deadline;
    bool is_ours = false;
    bool is_ended = false;
  };

  void add(SoupServerMessage *message);
  void read(SoupServerMessage *message);
  Connection *find(SoupServerMessage *message);
  bool make_room();
  void close_late();
  static void end(GSocket *socket, Connection &connection);
  static void gone(gpointer self, GObject *socket);

  SoupServer *server_;
  guint16 port_ = 0;
  std::map<GSocket *, Connection> connections_; ///< the open ones
  guint tick_ = 0;
};
