// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow/players/mpv_player.h"

#include "follow/players/line_buffer.h"
#include "follow/players/mpv_conversation.h"

#include <gio/gio.h>
#include <gio/gunixsocketaddress.h>
#include <sys/un.h>

#include <array>
#include <utility>

namespace follow {

namespace {

using Error = tl::unexpected<std::string>;

/// A player of 1000 frames a second tells less; one that tells more would keep this thread busy.
constexpr int kMostLines = 5000; ///< a second

struct Unref
{
  void operator()(gpointer object) const
  {
    g_object_unref(object);
  }
};

class MpvPlayer : public Player
{
public:
  MpvPlayer(std::string socket, PlayerEvents events)
      : name_("mpv at " + std::move(socket)), events_(std::move(events))
  {
  }
  ~MpvPlayer() override
  {
    if (source_ == nullptr)
      return;
    g_source_destroy(source_);
    g_source_unref(source_);
  }
  MpvPlayer(const MpvPlayer &) = delete;
  MpvPlayer &operator=(const MpvPlayer &) = delete;

  tl::expected<void, std::string> open(const std::string &path)
  {
    if (path.size() >= sizeof(sockaddr_un::sun_path))
      return Error("expected a path of fewer than " + std::to_string(sizeof(sockaddr_un::sun_path))
                   + " bytes");
    g_autoptr(GError) error = nullptr;
    socket_.reset(g_socket_new(G_SOCKET_FAMILY_UNIX, G_SOCKET_TYPE_STREAM,
                               G_SOCKET_PROTOCOL_DEFAULT, &error));
    g_autoptr(GSocketAddress) address = g_unix_socket_address_new(path.c_str());
    const std::string questions = MpvConversation::questions();
    // A local socket connects at once or not at all.
    if (!socket_ || !g_socket_connect(socket_.get(), address, nullptr, &error))
      return Error(error->message);
    g_socket_set_blocking(socket_.get(), FALSE);
    if (g_socket_send(socket_.get(), questions.data(), questions.size(), nullptr, &error)
        != static_cast<gssize>(questions.size()))
      return Error(error ? error->message : "it takes no questions");
    source_ = g_socket_create_source(socket_.get(), G_IO_IN, nullptr);
    g_source_set_callback(source_,
                          G_SOURCE_FUNC(+[](GSocket *, GIOCondition, gpointer self) -> gboolean {
                            return static_cast<MpvPlayer *>(self)->on_readable();
                          }),
                          this, nullptr);
    g_source_attach(source_, g_main_context_get_thread_default());
    return {};
  }

  const std::string &name() const override
  {
    return name_;
  }
  Habits habits() const override
  {
    return {};
  }

private:
  gboolean on_readable()
  {
    std::array<char, 16'384> bytes{};
    g_autoptr(GError) error = nullptr;
    const gssize size
        = g_socket_receive(socket_.get(), bytes.data(), bytes.size(), nullptr, &error);
    if (size < 0 && g_error_matches(error, G_IO_ERROR, G_IO_ERROR_WOULD_BLOCK))
      return G_SOURCE_CONTINUE;
    if (size < 0)
      return gone(error->message);
    if (size == 0)
      return gone("it has closed its socket");
    const Time now = local_time();
    if (!lines_.add({ bytes.data(), static_cast<std::size_t>(size) }))
      return gone("expected lines of at most " + std::to_string(LineBuffer::kLongestLine)
                  + " bytes");
    while (const std::optional<std::string> line = lines_.next()) {
      if (is_flood(now))
        return gone("it sends more than " + std::to_string(kMostLines) + " lines a second");
      if (const std::optional<Report> report = conversation_.received(*line, now))
        events_.reported(*report);
    }
    return G_SOURCE_CONTINUE;
  }

  bool is_flood(Time now)
  {
    if (now - counted_from_ >= std::chrono::seconds(1)) {
      counted_from_ = now;
      counted_ = 0;
    }
    return ++counted_ > kMostLines;
  }

  gboolean gone(const std::string &why)
  {
    events_.gone(why);
    return G_SOURCE_REMOVE;
  }

  const std::string name_;
  const PlayerEvents events_;
  std::unique_ptr<GSocket, Unref> socket_;
  GSource *source_ = nullptr;
  LineBuffer lines_;
  MpvConversation conversation_;
  Time counted_from_{ 0 };
  int counted_ = 0;
};

} // namespace

tl::expected<std::unique_ptr<Player>, std::string>
open_mpv(const std::string &socket, PlayerEvents events)
{
  auto player = std::make_unique<MpvPlayer>(socket, std::move(events));
  if (const auto opened = player->open(socket); !opened)
    return Error("cannot reach mpv at '" + socket + "': " + opened.error()
                 + "; was it started with --input-ipc-server=" + socket + "?");
  return player;
}

} // namespace follow
