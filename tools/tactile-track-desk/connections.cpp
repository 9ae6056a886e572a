// SPDX-License-Identifier: LGPL-2.1-or-later
#include "connections.h"

#include <limits>
#include <stdexcept>
#include <string>

namespace {

constexpr gint64 kNone = std::numeric_limits<gint64>::max() / 2;

} // namespace

Connections::Connections(SoupServer *server, guint16 port)
    : server_(server), service_(g_socket_service_new())
{
  g_autoptr(GInetAddress) loopback = g_inet_address_new_loopback(G_SOCKET_FAMILY_IPV4);
  g_autoptr(GSocketAddress) wanted = g_inet_socket_address_new(loopback, port);
  g_autoptr(GSocketAddress) bound = nullptr;
  g_autoptr(GError) error = nullptr;
  if (!g_socket_listener_add_address(G_SOCKET_LISTENER(service_), wanted, G_SOCKET_TYPE_STREAM,
                                     G_SOCKET_PROTOCOL_TCP, nullptr, &bound, &error)) {
    g_object_unref(service_);
    throw std::runtime_error("--port=" + std::to_string(port) + ": " + error->message
                             + "; give another, or none");
  }
  port_ = g_inet_socket_address_get_port(G_INET_SOCKET_ADDRESS(bound));
  g_signal_connect(service_, "incoming",
                   G_CALLBACK(+[](GSocketService *, GSocketConnection *connection, GObject *,
                                  gpointer self) -> gboolean {
                     return static_cast<Connections *>(self)->accept(connection);
                   }),
                   this);
  g_signal_connect(server_, "request-started",
                   G_CALLBACK(+[](SoupServer *, SoupServerMessage *message, gpointer self) {
                     static_cast<Connections *>(self)->set_deadline(message, kRequest);
                   }),
                   this);
  g_signal_connect(server_, "request-read",
                   G_CALLBACK(+[](SoupServer *, SoupServerMessage *message, gpointer self) {
                     static_cast<Connections *>(self)->set_deadline(
                         message, kNone);
                   }),
                   this);
  g_signal_connect(server_, "request-finished",
                   G_CALLBACK(+[](SoupServer *, SoupServerMessage *message, gpointer self) {
                     static_cast<Connections *>(self)->set_deadline(message, kIdle);
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
  g_signal_handlers_disconnect_by_data(service_, this);
  g_socket_service_stop(service_);
  g_object_unref(service_);
  for (const auto &[socket, deadline] : deadlines_)
    g_object_unref(socket);
}

bool
Connections::accept(GSocketConnection *connection)
{
  close_late(); // forgets those that are closed
  if (deadlines_.size() >= kMost)
    return true; // which closes it
  GSocket *socket = g_socket_connection_get_socket(connection);
  g_autoptr(GSocketAddress) local = g_socket_connection_get_local_address(connection, nullptr);
  g_autoptr(GSocketAddress) remote = g_socket_connection_get_remote_address(connection, nullptr);
  deadlines_[G_SOCKET(g_object_ref(socket))] = g_get_monotonic_time() + kRequest;
  soup_server_accept_iostream(server_, G_IO_STREAM(connection), local, remote, nullptr);
  return true;
}

void
Connections::set_deadline(SoupServerMessage *message, gint64 span)
{
  GSocket *socket = soup_server_message_get_socket(message);
  const auto found = deadlines_.find(socket);
  if (found != deadlines_.end())
    found->second = g_get_monotonic_time() + span;
}

void
Connections::close_late()
{
  const gint64 now = g_get_monotonic_time();
  std::erase_if(deadlines_, [now](const auto &one) {
    const auto &[socket, deadline] = one;
    if (!g_socket_is_closed(socket) && deadline > now)
      return false;
    g_socket_shutdown(socket, TRUE, TRUE, nullptr); // its stream closes it
    g_object_unref(socket);
    return true;
  });
}
