// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow/players/mpv_player.h"

#include "follow/players/line_buffer.h"
#include "follow/players/mpv_conversation.h"
#include "follow/players/player_socket.h"

#include <gio/gio.h>
#include <gio/gunixsocketaddress.h>
#include <sys/un.h>

#include <chrono>
#include <optional>
#include <utility>

namespace follow {

namespace {

using Error = tl::unexpected<std::string>;

constexpr Time kAskAfter = std::chrono::milliseconds(90);

class MpvPlayer : public Player
{
public:
  MpvPlayer(std::string socket, PlayerEvents events)
      : name_("mpv at " + std::move(socket)), events_(std::move(events))
  {
  }
  tl::expected<void, std::string> open(const std::string &path)
  {
    if (path.size() >= sizeof(sockaddr_un::sun_path))
      return Error("expected a path of fewer than " + std::to_string(sizeof(sockaddr_un::sun_path))
                   + " bytes");
    g_autoptr(GError) error = nullptr;
    g_autoptr(GSocket) socket = g_socket_new(G_SOCKET_FAMILY_UNIX, G_SOCKET_TYPE_STREAM,
                                             G_SOCKET_PROTOCOL_DEFAULT, &error);
    g_autoptr(GSocketAddress) address = g_unix_socket_address_new(path.c_str());
    // A local socket connects at once or not at all.
    if (socket == nullptr || !g_socket_connect(socket, address, nullptr, &error))
      return Error(error->message);
    socket_.emplace(
        socket, PlayerSocket::Events{ .received = [this](std::string_view bytes,
                                                         Time now) { return received(bytes, now); },
                                      .gone = events_.gone });
    if (const std::string wrong = socket_->send(MpvConversation::questions()); !wrong.empty())
      return Error(wrong);
    static GSourceFuncs timer{ .dispatch
                               = +[](GSource *, GSourceFunc ask, gpointer self) -> gboolean {
      return ask(self);
    } };
    timer_ = g_source_new(&timer, sizeof(GSource));
    g_source_set_ready_time(timer_, -1);
    g_source_set_callback(
        timer_,
        +[](gpointer self) -> gboolean {
          static_cast<MpvPlayer *>(self)->ask_for_life();
          return G_SOURCE_CONTINUE;
        },
        this, nullptr);
    g_source_attach(timer_, g_main_context_get_thread_default());
    return {};
  }
  ~MpvPlayer() override
  {
    if (timer_ != nullptr) {
      g_source_destroy(timer_);
      g_source_unref(timer_);
    }
  }
  MpvPlayer(const MpvPlayer &) = delete;
  MpvPlayer &operator=(const MpvPlayer &) = delete;

  const std::string &name() const override
  {
    return name_;
  }
  Habits habits() const override
  {
    return {};
  }

private:
  bool received(std::string_view bytes, Time now)
  {
    if (!lines_.add(bytes))
      return gone("expected lines of at most " + std::to_string(LineBuffer::kLongestLine)
                  + " bytes");
    while (const std::optional<std::string> line = lines_.next()) {
      if (socket_->is_flood(now))
        return gone(PlayerSocket::flood());
      if (const std::optional<Report> report = conversation_.received(*line, now))
        events_.reported(*report);
    }
    const auto at = std::chrono::duration_cast<std::chrono::microseconds>(now + kAskAfter);
    g_source_set_ready_time(timer_, conversation_.plays() ? at.count() : -1);
    return true;
  }

  /// Where frames are far apart, nothing comes for long.
  void ask_for_life()
  {
    g_source_set_ready_time(timer_, -1); // the answer sets it again
    socket_->send(MpvConversation::life_sign());
  }

  bool gone(const std::string &why)
  {
    events_.gone(why);
    return false;
  }

  const std::string name_;
  const PlayerEvents events_;
  LineBuffer lines_;
  MpvConversation conversation_;
  GSource *timer_ = nullptr; ///< since the last bytes
  std::optional<PlayerSocket> socket_;
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
