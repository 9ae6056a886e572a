// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "follow/report.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

typedef struct _JsonObject JsonObject;

namespace follow {

/// Kodi's JSON-RPC: it notifies of events, and answers queries for its position. Reads no clock,
/// has no socket, and is not thread-safe.
class KodiConversation
{
public:
  struct Heard
  {
    std::optional<Report> report{}; ///< if the message has one
    std::string questions{};        ///< to be sent now
  };

  /// A query whether a server on the default port is Kodi. The answer is one of is_pong().
  static std::string ping();
  static bool is_pong(std::string_view object);

  /// The first queries of an open connection: which film plays.
  std::string begin(Time now);

  /// An object of any content, received at a local time.
  Heard received(std::string_view object, Time now);

  /// Asks for the position, at a local time: each time while a film plays, otherwise once a second
  /// for what is open. Empty while an answer is awaited.
  std::string ask(Time now);

  /// Whether an answer has been overdue for too long.
  bool is_silent(Time now) const;

private:
  std::string question(const char *method, const std::string &parameters, std::int64_t &id);
  std::string ask_for_item();
  std::string ask_for_position(Time now);
  bool awaits() const;
  Heard told(const std::string &what, JsonObject *fields, Time now);
  Heard answered(std::int64_t id, JsonObject *fields, Time now);
  Heard has_players(JsonObject *fields, Time now);
  Heard has_properties(JsonObject *fields, Time now);
  Heard is_over(Time now);
  void take_seek(JsonObject *player, Time now);
  bool is_of_before(Time position, Time now) const;
  Report report(Time now) const;

  /// The number of the last query of each kind; 0: no answer is awaited.
  struct Awaited
  {
    std::int64_t players = 0;
    std::int64_t item = 0;
    std::int64_t properties = 0;
  };
  /// The target of a seek.
  struct Seek
  {
    Time at{ 0 }; ///< local time of its report
    Time to{ 0 };
  };

  std::int64_t last_id_ = 0;
  Awaited awaited_;
  Time asked_{ 0 };                    ///< local time of the last question
  std::optional<std::int64_t> player_; ///< that shows a film
  std::string film_;                   ///< empty: unknown
  double speed_ = 0;                   ///< film seconds a second; 0: pause
  std::optional<Seek> seek_;           ///< without a report of a position so far
  bool sought_ = false;                ///< a seek without a report of a position so far
};

} // namespace follow
