// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow/players/kodi_player.h"

#include "follow/players/json_stream.h"
#include "follow/players/kodi_conversation.h"
#include "follow/players/player_socket.h"

#include <utility>

namespace follow {

namespace {

constexpr const char *kNoKodi = "what answers is not Kodi";

class KodiPlayer : public Player
{
public:
  KodiPlayer(GSocketConnection *connection, PlayerEvents events)
      : events_(std::move(events)), connection_(connection),
        socket_(
            g_socket_connection_get_socket(connection),
            { .received = [this](std::string_view bytes, Time now) { return received(bytes, now); },
              .gone = events_.gone })
  {
    g_object_ref(connection_);
    socket_.send(conversation_.begin(local_time())); // if it fails, the connection is gone
    timer_ = g_timeout_add(kAskEvery, on_timer, this);
  }
  ~KodiPlayer() override
  {
    g_source_remove(timer_);
    g_object_unref(connection_);
  }
  KodiPlayer(const KodiPlayer &) = delete;
  KodiPlayer &operator=(const KodiPlayer &) = delete;

  const std::string &name() const override
  {
    return name_;
  }
  Habits habits() const override
  {
    return { .coarseness = kCoarseness, .lingers = true };
  }
  Time sound_latency() const override
  {
    return kSoundLater;
  }
  void ask() override
  {
    send(conversation_.ask(local_time()));
  }

private:
  /// Kodi 20 renews its time each 0.2 s, and seldom later. A hundredth of a second times the golden
  /// section, so that questions never fall in step with that.
  static constexpr guint kAskEvery = 62; ///< ms
  /// Than the picture (docs/measured/follow.md).
  static constexpr Time kSoundLater = std::chrono::milliseconds(75);
  static constexpr Time kCoarseness = std::chrono::milliseconds(300);

  bool received(std::string_view bytes, Time now)
  {
    if (!objects_.add(bytes))
      return gone("expected JSON objects of at most " + std::to_string(JsonStream::kLongest)
                  + " bytes");
    while (const std::optional<std::string> object = objects_.next()) {
      if (socket_.is_flood(now))
        return gone(PlayerSocket::flood());
      const KodiConversation::Heard heard = conversation_.received(*object, now);
      if (heard.report)
        events_.reported(*heard.report);
      send(heard.questions);
    }
    return true;
  }

  void send(const std::string &questions)
  {
    if (!questions.empty())
      socket_.send(questions); // fails on a lost connection, which gone() reports
  }

  bool gone(const std::string &why)
  {
    if (!std::exchange(is_gone_, true))
      events_.gone(why);
    return false;
  }

  static gboolean on_timer(gpointer data)
  {
    auto *self = static_cast<KodiPlayer *>(data);
    if (self->conversation_.is_silent(local_time()))
      self->gone("it does not answer any more");
    else
      self->ask();
    return G_SOURCE_CONTINUE;
  }

  const std::string name_ = "kodi";
  const PlayerEvents events_;
  GSocketConnection *connection_;
  JsonStream objects_;
  KodiConversation conversation_;
  bool is_gone_ = false;
  guint timer_ = 0;
  PlayerSocket socket_;
};

} // namespace

std::unique_ptr<Player>
open_kodi(GSocketConnection *connection, PlayerEvents events)
{
  return std::make_unique<KodiPlayer>(connection, std::move(events));
}

KodiSearch::KodiSearch(std::string address, Events events)
    : address_(std::move(address)), events_(std::move(events)), canceled_(g_cancellable_new())
{
}

KodiSearch::~KodiSearch()
{
  g_cancellable_cancel(canceled_); // answers are dropped from now on
  g_object_unref(canceled_);
  g_clear_object(&connection_);
}

void
KodiSearch::look()
{
  constexpr guint kLongestAnswer = 3; ///< s
  if (std::exchange(looks_, true))
    return;
  objects_ = {};
  count_ = 0;
  g_autoptr(GSocketClient) client = g_socket_client_new();
  g_socket_client_set_timeout(client, kLongestAnswer);
  g_socket_client_connect_to_host_async(client, address_.c_str(), kKodiPort, canceled_,
                                        on_connected, this);
}

void
KodiSearch::miss(const std::string &why, bool is_other)
{
  g_clear_object(&connection_);
  looks_ = false;
  events_.missed(why, is_other);
}

void
KodiSearch::on_connected(GObject *client, GAsyncResult *result, gpointer data)
{
  g_autoptr(GError) error = nullptr;
  g_autoptr(GSocketConnection) connection
      = g_socket_client_connect_to_host_finish(G_SOCKET_CLIENT(client), result, &error);
  if (g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED)) // this is no more
    return;
  auto *self = static_cast<KodiSearch *>(data);
  if (connection == nullptr)
    return self->miss(error->message, false);
  const std::string ping = KodiConversation::ping();
  if (g_socket_send(g_socket_connection_get_socket(connection), ping.data(), ping.size(), nullptr,
                    &error)
      != static_cast<gssize>(ping.size()))
    return self->miss(error != nullptr ? error->message : kNoKodi, false);
  self->connection_ = static_cast<GSocketConnection *>(g_steal_pointer(&connection));
  self->read_on();
}

void
KodiSearch::read_on()
{
  constexpr gsize kMost = 4096;
  g_input_stream_read_bytes_async(g_io_stream_get_input_stream(G_IO_STREAM(connection_)), kMost,
                                  G_PRIORITY_DEFAULT, canceled_, on_read, this);
}

void
KodiSearch::on_read(GObject *stream, GAsyncResult *result, gpointer data)
{
  constexpr std::size_t kMostBefore = 65'536; ///< bytes of notifications before the answer
  g_autoptr(GError) error = nullptr;
  g_autoptr(GBytes) bytes
      = g_input_stream_read_bytes_finish(G_INPUT_STREAM(stream), result, &error);
  if (g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED)) // this is no more
    return;
  auto *self = static_cast<KodiSearch *>(data);
  if (bytes == nullptr)
    return self->miss(error->message, g_error_matches(error, G_IO_ERROR, G_IO_ERROR_TIMED_OUT));
  gsize size = 0;
  const auto *text = static_cast<const char *>(g_bytes_get_data(bytes, &size));
  self->count_ += size;
  if (size == 0 || self->count_ > kMostBefore || !self->objects_.add({ text, size }))
    return self->miss(kNoKodi, true);
  while (const std::optional<std::string> object = self->objects_.next())
    if (KodiConversation::is_pong(*object)) {
      g_autoptr(GSocketConnection) connection
          = static_cast<GSocketConnection *>(g_steal_pointer(&self->connection_));
      self->looks_ = false;
      return self->events_.found(connection);
    }
  self->read_on();
}

} // namespace follow
