// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow/players/player_socket.h"

#include <array>
#include <utility>

namespace follow {

namespace {

/// A player of 1000 frames a second sends fewer messages.
constexpr int kMostMessages = 5000; ///< a second

} // namespace

PlayerSocket::PlayerSocket(GSocket *socket, Events events)
    : events_(std::move(events)), socket_(socket),
      source_(g_socket_create_source(socket, G_IO_IN, nullptr))
{
  g_object_ref(socket_);
  g_socket_set_blocking(socket_, FALSE);
  g_socket_set_timeout(socket_, 0);
  g_source_set_callback(source_,
                        G_SOURCE_FUNC(+[](GSocket *, GIOCondition, gpointer self) -> gboolean {
                          return static_cast<PlayerSocket *>(self)->on_readable();
                        }),
                        this, nullptr);
  g_source_attach(source_, g_main_context_get_thread_default());
}

PlayerSocket::~PlayerSocket()
{
  g_source_destroy(source_);
  g_source_unref(source_);
  g_object_unref(socket_);
}

std::string
PlayerSocket::send(std::string_view bytes)
{
  g_autoptr(GError) error = nullptr;
  if (g_socket_send(socket_, bytes.data(), bytes.size(), nullptr, &error)
      == static_cast<gssize>(bytes.size()))
    return {};
  return error ? error->message : "it takes no questions";
}

gboolean
PlayerSocket::on_readable()
{
  std::array<char, 16'384> bytes{};
  g_autoptr(GError) error = nullptr;
  const gssize size = g_socket_receive(socket_, bytes.data(), bytes.size(), nullptr, &error);
  if (size < 0 && g_error_matches(error, G_IO_ERROR, G_IO_ERROR_WOULD_BLOCK))
    return G_SOURCE_CONTINUE;
  if (size < 0)
    return gone(error->message);
  if (size == 0)
    return gone("it has closed its connection");
  return events_.received({ bytes.data(), static_cast<std::size_t>(size) }, local_time())
             ? G_SOURCE_CONTINUE
             : G_SOURCE_REMOVE;
}

bool
PlayerSocket::is_flood(Time now)
{
  if (now - counted_from_ >= std::chrono::seconds(1)) {
    counted_from_ = now;
    counted_ = 0;
  }
  return ++counted_ > kMostMessages;
}

std::string
PlayerSocket::flood()
{
  return "it sends more than " + std::to_string(kMostMessages) + " messages a second";
}

gboolean
PlayerSocket::gone(const std::string &why)
{
  events_.gone(why);
  return G_SOURCE_REMOVE;
}

} // namespace follow
