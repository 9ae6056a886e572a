// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "follow/players/media_server.h"
#include "follow/players/player.h"

#include <gio/gio.h>

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

/// How a media server is reached.
struct ServerSettings
{
  follow::ServerKind kind{};
  std::string address{}; ///< http://HOST:PORT
  std::string token{};
  std::string device{}; ///< only the session on this device; empty: any
};

/// Follows a session of a media server, which a thread of its own queries. Thread of the main
/// context in which it was made.
class ServerPlayer : public follow::Player
{
public:
  /// `said` is called with the first answer.
  ServerPlayer(ServerSettings settings, follow::PlayerEvents events,
               std::function<void(const std::string &)> said);
  ~ServerPlayer() override;
  ServerPlayer(const ServerPlayer &) = delete;
  ServerPlayer &operator=(const ServerPlayer &) = delete;

  const std::string &name() const override
  {
    return name_;
  }
  follow::Habits habits() const override
  {
    return follow::MediaServer::habits(settings_.kind);
  }
  const std::string &fault() const override
  {
    return server_.fault();
  }
  follow::Source source() const override
  {
    return follow::Source::media_server;
  }
  bool is_announced() const override
  {
    return false;
  }

private:
  /// From the thread for the main context.
  struct Answer
  {
    tl::expected<std::string, std::string> body;
    follow::Time asked{ 0 };
    follow::Time received{ 0 };
  };

  void query();
  void take(const Answer &answer);

  const std::string name_;
  const ServerSettings settings_;
  const follow::PlayerEvents events_;
  const std::function<void(const std::string &)> said_;
  follow::MediaServer server_;
  bool is_there_ = false;
  GMainContext *context_;
  GCancellable *stop_;
  std::mutex mutex_; ///< guards the next four
  std::condition_variable wake_;
  bool stops_ = false;
  bool plays_ = false;        ///< a film is open
  GSource *source_ = nullptr; ///< until it was dispatched
  std::unique_ptr<Answer> answer_;
  std::thread thread_;
};
