// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow/players/media_server.h"

#include "json/json_reader.h"

#include <algorithm>
#include <cmath>

namespace follow {

namespace {

using Session = MediaServer::Session;

constexpr guint kMostSessions = 1000;

/// Converts a count of units of `unit`, if a film can be as long.
std::optional<Time>
position_of(JsonObject *of, const char *name, Time unit)
{
  constexpr Time kLongest = std::chrono::hours(1000);
  const auto count = json::integer(of, name, 0, kLongest / unit);
  return count ? std::optional(unit * *count) : std::nullopt;
}

/// The name of a film, of a path on any system.
std::string
film_of(const std::string &path, const std::string &title)
{
  if (path.empty())
    return title;
  return path.starts_with('/') ? path : path.substr(path.rfind('\\') + 1);
}

/// An item of BaseItemDto with its PlayState, of Jellyfin and Emby.
std::optional<Session>
jellyfin_session(JsonObject *session)
{
  constexpr Time kTick(100);
  JsonObject *item = json::object(session, "NowPlayingItem");
  JsonObject *state = json::object(session, "PlayState");
  if (item == nullptr || state == nullptr || json::text(item, "MediaType") != "Video")
    return std::nullopt;
  const std::string path = json::name_of_file(item, "Path");
  return Session{ .id = json::text(session, "Id"),
                  .device = json::text(session, "DeviceName"),
                  .film = film_of(path, json::name_of_file(item, "Name")),
                  .position = position_of(state, "PositionTicks", kTick),
                  .doing
                  = json::truth(state, "IsPaused").value_or(false) ? Doing::paused : Doing::playing,
                  .rate = json::number(state, "PlaybackRate").value_or(1),
                  .report = json::text(session, "LastPlaybackCheckIn") };
}

/// The file of a film of Plex: Media and Part are lists, of which the one that plays is "selected".
std::string
plex_file(JsonObject *item)
{
  const auto chosen = [](JsonArray *of) -> JsonObject * {
    JsonObject *first = nullptr;
    for (guint i = 0; of != nullptr && i < json_array_get_length(of); i++) {
      JsonObject *one = json::object(of, i);
      if (json::truth(one, "selected").value_or(false))
        return one;
      first = first != nullptr ? first : one;
    }
    return first;
  };
  return json::name_of_file(chosen(json::array(chosen(json::array(item, "Media")), "Part")),
                            "file");
}

std::optional<Session>
plex_session(JsonObject *item)
{
  JsonObject *player = json::object(item, "Player");
  const std::string type = json::text(item, "type");
  if (player == nullptr || type == "track" || type == "photo")
    return std::nullopt;
  const std::string state = json::text(player, "state");
  const auto position = position_of(item, "viewOffset", std::chrono::milliseconds(1));
  return Session{ .id = json::text(player, "machineIdentifier"),
                  .device = json::text(player, "title"),
                  .film = film_of(plex_file(item), json::name_of_file(item, "title")),
                  .position = position,
                  .doing = state == "paused"      ? Doing::paused
                           : state == "buffering" ? Doing::stalled
                                                  : Doing::playing,
                  .report = position ? std::to_string(position->count()) : "" };
}

/// The list of sessions; null: the answer has another form.
JsonArray *
list_of(JsonParser *parser, ServerKind kind)
{
  JsonNode *root = parser != nullptr ? json_parser_get_root(parser) : nullptr;
  if (root == nullptr)
    return nullptr;
  if (kind != ServerKind::plex)
    return JSON_NODE_HOLDS_ARRAY(root) ? json_node_get_array(root) : nullptr;
  return JSON_NODE_HOLDS_OBJECT(root)
             ? json::array(json::object(json_node_get_object(root), "MediaContainer"), "Metadata")
             : nullptr;
}

/// Plex leaves the list out if nobody plays anything.
bool
is_empty_plex(JsonParser *parser)
{
  JsonNode *root = parser != nullptr ? json_parser_get_root(parser) : nullptr;
  return root != nullptr && JSON_NODE_HOLDS_OBJECT(root)
         && json::integer(json::object(json_node_get_object(root), "MediaContainer"), "size") == 0;
}

} // namespace

const char *
name_of(ServerKind kind)
{
  switch (kind) {
  case ServerKind::jellyfin:
    return "jellyfin";
  case ServerKind::emby:
    return "emby";
  case ServerKind::plex:
    return "plex";
  }
  return "";
}

MediaServer::MediaServer(ServerKind kind, std::string device)
    : kind_(kind), device_(std::move(device))
{
}

MediaServer::Query
MediaServer::query(ServerKind kind, const std::string &token)
{
  switch (kind) {
  case ServerKind::jellyfin:
    return { "Sessions", { { "Authorization", "MediaBrowser Token=\"" + token + "\"" } } };
  case ServerKind::emby:
    return { "Sessions", { { "X-Emby-Token", token } } };
  case ServerKind::plex:
    return { "status/sessions", { { "X-Plex-Token", token }, { "Accept", "application/json" } } };
  }
  return {};
}

Habits
MediaServer::habits(ServerKind kind)
{
  using namespace std::chrono_literals;
  constexpr Time kAnswer = 30ms; ///< of a server in the same house
  constexpr Time kSkew = 500us;
  if (kind == ServerKind::plex)
    return {
      .latest = kAskEvery + kAnswer, .skew = kSkew, .least_patience = 2s, .most_patience = 5s
    };
  return {
    .coarseness = 1050ms, .lingers = true, .skew = kSkew, .least_patience = 2s, .most_patience = 5s
  };
}

const Session *
MediaServer::choose(std::vector<Session> &sessions)
{
  if (!device_.empty())
    std::erase_if(sessions, [&](const Session &one) {
      return g_ascii_strcasecmp(one.device.c_str(), device_.c_str()) != 0;
    });
  const auto is_paused = [](const Session &one) {
    return one.doing == Doing::paused;
  };
  const bool all_are_paused = std::ranges::all_of(sessions, is_paused);
  if (!all_are_paused)
    std::erase_if(sessions, is_paused);
  for (Session &one : sessions)
    one.id = one.id.empty() ? one.device + '/' + one.film : one.id;
  auto chosen = std::ranges::find(sessions, followed_, &Session::id);
  if (chosen == sessions.end() && sessions.size() == 1)
    chosen = sessions.begin();
  fault_.clear();
  followed_.clear();
  if (chosen != sessions.end()) {
    followed_ = chosen->id;
    return &*chosen;
  }
  if (!sessions.empty() && !all_are_paused)
    fault_ = "'" + sessions[0].device + "' and '" + sessions[1].device
             + "' play; expected one, or device= with the name of one in the settings";
  return nullptr;
}

/// Whether the position of a report is one of this moment, not of a report of the player long ago.
bool
MediaServer::is_fresh(const Report &report, Time now)
{
  constexpr int kMostLate = 3;
  if (kind_ != ServerKind::plex || report.doing != Doing::playing)
    return true;
  if (!last_
      || (last_->film == report.film && last_->doing == report.doing
          && last_->position == report.position)) {
    if (late_ >= kMostLate)
      fault_ = "the server answers too slowly; expected an answer within 0.2 s";
    return false;
  }
  const bool is_fresh = now - last_->received <= habits(kind_).latest;
  late_ = is_fresh ? 0 : late_ + 1;
  return is_fresh;
}

/// Whether the player has not reported for so long that it is gone, though the server counts on.
bool
MediaServer::is_silent(const Session &session, Time now)
{
  if (session.report.empty() || session.doing != Doing::playing || session.report != reported_) {
    reported_ = session.report;
    reported_at_ = now;
  }
  return now - reported_at_ > kGone;
}

tl::expected<Report, std::string>
MediaServer::received(std::string_view answer, Time asked, Time now)
{
  g_autoptr(JsonParser) parser = json::parse(answer);
  JsonArray *list = list_of(parser, kind_);
  if (list == nullptr && !(kind_ == ServerKind::plex && is_empty_plex(parser)))
    return tl::unexpected(std::string("expected the sessions of ") + name_of(kind_)
                          + " in JSON, got something else; is it the address of the server?");
  std::vector<Session> sessions;
  for (guint i = 0; list != nullptr && i < std::min(json_array_get_length(list), kMostSessions);
       i++) {
    JsonObject *one = json::object(list, i);
    if (const auto session = kind_ == ServerKind::plex ? plex_session(one) : jellyfin_session(one);
        session && !session->film.empty())
      sessions.push_back(*session);
  }
  const Session *session = choose(sessions);
  Report report{ .received = now, .doing = Doing::stopped };
  if (session != nullptr)
    report = { .received = now,
               .asked = kind_ == ServerKind::plex ? std::nullopt : std::optional(asked),
               .position = session->position,
               .doing = is_silent(*session, now) ? Doing::stalled : session->doing,
               .rate = session->rate,
               .film = session->film };
  const bool has_position = is_fresh(report, now);
  last_ = report;
  if (!has_position)
    report.position.reset();
  return report;
}

} // namespace follow
