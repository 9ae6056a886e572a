// SPDX-License-Identifier: LGPL-2.1-or-later
#include "connections.h"
#include "translation.h"

#include <limits>
#include <stdexcept>
#include <string>

namespace {

constexpr gint64 kNone = std::numeric_limits<gint64>::max() / 2;

bool
listen(SoupServer *server, guint16 port, GError **error)
{
  g_autoptr(GInetAddress) loopback = g_inet_address_new_loopback(G_SOCKET_FAMILY_IPV4);
  g_autoptr(GSocketAddress) address = g_inet_socket_address_new(loopback, port);
  return soup_server_listen(server, address, static_cast<SoupServerListenOptions>(0), error)
         != FALSE;
}

} // namespace

Connections::Connections(SoupServer *server, guint16 port, guint16 usual) : server_(server)
{
  g_autoptr(GError) error = nullptr;
  if (!(port == 0 && listen(server_, usual, nullptr)) && !listen(server_, port, &error))
    throw std::runtime_error(
        in_text("--port={}: {}; give another, or none", std::to_string(port), error->message));
  GSList *addresses = soup_server_get_uris(server_);
  port_ = static_cast<guint16>(g_uri_get_port(static_cast<GUri *>(addresses->data)));
  g_slist_free_full(addresses, reinterpret_cast<GDestroyNotify>(g_uri_unref));
  // Also for a connection that has said nothing yet.
  g_signal_connect(server_, "request-started",
                   G_CALLBACK(+[](SoupServer *, SoupServerMessage *message, gpointer self) {
                     static_cast<Connections *>(self)->add(message);
                   }),
                   this);
  g_signal_connect(server_, "request-read",
                   G_CALLBACK(+[](SoupServer *, SoupServerMessage *message, gpointer self) {
                     static_cast<Connections *>(self)->read(message);
                   }),
                   this);
  tick_ = g_timeout_add_seconds(
      1,
      +[](gpointer self) -> gboolean {
        static_cast<Connections *>(self)->close_late();
        return G_SOURCE_CONTINUE;
      },
      this);
}

Connections::~Connections()
{
  g_source_remove(tick_);
  g_signal_handlers_disconnect_by_data(server_, this);
  for (const auto &[socket, connection] : connections_)
    g_object_weak_unref(G_OBJECT(socket), gone, this);
}

Connections::Connection *
Connections::find(SoupServerMessage *message)
{
  const auto found = connections_.find(soup_server_message_get_socket(message));
  return found != connections_.end() ? &found->second : nullptr;
}

void
Connections::add(SoupServerMessage *message)
{
  GSocket *socket = soup_server_message_get_socket(message);
  if (socket == nullptr || g_socket_is_closed(socket) || find(message) != nullptr)
    return;
  if (!make_room()) {
    g_socket_shutdown(socket, TRUE, TRUE, nullptr);
    return;
  }
  connections_[socket] = { .deadline = g_get_monotonic_time() + kUnknown };
  g_object_weak_ref(G_OBJECT(socket), gone, this);
}

void
Connections::admit(SoupServerMessage *message)
{
  if (Connection *connection = find(message)) {
    connection->is_ours = true;
    connection->deadline = g_get_monotonic_time() + kRequest;
  }
}

/// An answer takes as long as it takes; to others it is short.
void
Connections::read(SoupServerMessage *message)
{
  if (Connection *connection = find(message); connection != nullptr && connection->is_ours)
    connection->deadline = kNone;
}

void
Connections::gone(gpointer self, GObject *socket)
{
  static_cast<Connections *>(self)->connections_.erase(reinterpret_cast<GSocket *>(socket));
}

/// Shuts the socket down, which ends the connection.
void
Connections::end(GSocket *socket, Connection &connection)
{
  connection.is_ended = true;
  g_socket_shutdown(socket, TRUE, TRUE, nullptr);
}

/// False if all connections have named the token.
bool
Connections::make_room()
{
  close_late();
  std::size_t count = 0;
  auto oldest = connections_.end();
  for (auto one = connections_.begin(); one != connections_.end(); ++one) {
    const Connection &connection = one->second;
    count += connection.is_ended ? 0 : 1;
    if (!connection.is_ended && !connection.is_ours
        && (oldest == connections_.end() || connection.deadline < oldest->second.deadline))
      oldest = one;
  }
  if (count < kMost)
    return true;
  if (oldest == connections_.end())
    return false;
  end(oldest->first, oldest->second);
  return true;
}

void
Connections::close_late()
{
  const gint64 now = g_get_monotonic_time();
  std::erase_if(connections_, [this](const auto &one) {
    if (!g_socket_is_closed(one.first))
      return false;
    g_object_weak_unref(G_OBJECT(one.first), gone, this);
    return true;
  });
  for (auto &[socket, connection] : connections_)
    if (!connection.is_ended && connection.deadline <= now)
      end(socket, connection);
}
