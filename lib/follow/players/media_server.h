// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "follow/evidence.h"
#include "follow/report.h"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

namespace follow {

/// A media server that knows what its players, such as televisions, play.
enum class ServerKind
{
  jellyfin,
  emby,
  plex,
};
inline constexpr ServerKind kServerKinds[]
    = { ServerKind::jellyfin, ServerKind::emby, ServerKind::plex };
const char *name_of(ServerKind kind);

/// The sessions of a media server, which are queried by HTTP. One of them is followed: the only one
/// that plays a film, or the one on the named device. Reads no clock, has no socket, and is not
/// thread-safe.
class MediaServer
{
public:
  /// A GET request for all sessions.
  struct Query
  {
    std::string path; ///< below the address of the server
    std::vector<std::pair<std::string, std::string>> headers;
  };

  /// Time between two queries. A second times no simple fraction, so that queries never fall in
  /// step with the seconds of the server.
  static constexpr Time kAskEvery = std::chrono::milliseconds(170);

  /// After so long without a report of the player, it is gone: players report each 10 s.
  static constexpr Time kGone = std::chrono::seconds(30);

  /// `device`: only the session on the device of that name; empty: any.
  MediaServer(ServerKind kind, std::string device);

  static Query query(ServerKind kind, const std::string &token);

  /// Jellyfin and Emby add one second to the position each second, between a player's own reports
  /// (SessionInfo.StartAutomaticProgress). Plex keeps the position of the player's last report,
  /// which comes every ten seconds and at once after a pause or a seek: its first is of no use.
  static Habits habits(ServerKind kind);

  /// Takes an answer of any content to a query of local time `asked`, received at `now`. The error
  /// says what was expected.
  tl::expected<Report, std::string> received(std::string_view answer, Time asked, Time now);

  /// The reason for which no session is followed; empty: none.
  const std::string &fault() const
  {
    return fault_;
  }

  /// One of the sessions that have a film.
  struct Session
  {
    std::string id;
    std::string device;
    std::string film; ///< its path on the server; else its title
    std::optional<Time> position{};
    Doing doing = Doing::playing;
    double rate = 1;
    /// Changes with each report of the player; empty: unknown.
    std::string report;
  };

private:
  const Session *choose(std::vector<Session> &sessions);
  bool is_fresh(const Report &report, Time now);
  bool is_silent(const Session &session, Time now);

  const ServerKind kind_;
  const std::string device_;
  std::string followed_; ///< session that is followed; empty: none
  std::string fault_;
  std::optional<Report> last_{}; ///< with the position of the last answer
  int late_ = 0;                 ///< changes of the position in a row, whose time is unknown
  std::string reported_;         ///< Session::report of the last answer
  Time reported_at_{ 0 };
};

} // namespace follow
