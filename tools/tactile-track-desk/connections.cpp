// SPDX-License-Identifier: LGPL-2.1-or-later
#include "connections.h"

#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

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
    throw std::runtime_error("--port=" + std::to_string(port) + ": " + error->message
                             + "; give another, or none");
  GSList *addresses = soup_server_get_uris(server_);
  port_ = static_cast<guint16>(g_uri_get_port(static_cast<GUri *>(addresses->data)));
  g_slist_free_full(addresses, reinterpret_cast<GDestroyNotify>(g_uri_unref));
  // Also for a connection that has said nothing yet.
  g_signal_connect(server_, "request-started",
                   G_CALLBACK(+[](SoupServer *, SoupServerMessage *message, gpointer self) {
                     static_cast<Connections *>(self)->set_deadline(message, kRequest);
                   }),
                   this);
  g_signal_connect(server_, "request-read",
                   G_CALLBACK(+[](SoupServer *, SoupServerMessage *message, gpointer self) {
                     static_cast<Connections *>(self)->set_deadline(message, kNone);
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
  for (const auto &[socket, deadline] : deadlines_)
    g_object_weak_unref(G_OBJECT(socket), gone, this);
}

void
Connections::set_deadline(SoupServerMessage *message, gint64 span)
{
  GSocket *socket = soup_server_message_get_socket(message);
  if (socket == nullptr || g_socket_is_closed(socket))
    return;
  const auto found = deadlines_.find(socket);
  if (found != deadlines_.end()) {
    found->second = g_get_monotonic_time() + span;
    return;
  }
  if (deadlines_.size() >= kMost)
    close_late();
  if (deadlines_.size() >= kMost) {
    g_socket_shutdown(socket, TRUE, TRUE, nullptr);
    return;
  }
  deadlines_[socket] = g_get_monotonic_time() + span;
  g_object_weak_ref(G_OBJECT(socket), gone, this);
}

void
Connections::gone(gpointer self, GObject *socket)
{
  static_cast<Connections *>(self)->deadlines_.erase(reinterpret_cast<GSocket *>(socket));
}

void
Connections::close_late()
{
  const gint64 now = g_get_monotonic_time();
  std::erase_if(deadlines_, [this](const auto &one) {
    if (!g_socket_is_closed(one.first))
      return false;
    g_object_weak_unref(G_OBJECT(one.first), gone, this);
    return true;
  });
  for (auto &[socket, deadline] : deadlines_)
    if (std::exchange(deadline, deadline > now ? deadline : kNone) <= now)
      g_socket_shutdown(socket, TRUE, TRUE, nullptr); // its connection ends by that
}
