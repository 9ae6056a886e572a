// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow/players/kodi_conversation.h"

#include "json/json_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace follow {

namespace {

using namespace std::chrono_literals;

/// A picture is on the screen when Kodi 20 reports the position that is so much before it
/// (docs/measured/follow.md).
constexpr Time kPictureAhead = 75ms;

/// After a seek, Kodi reports its old position for a while. During this time, positions far from
/// the target of the seek are skipped.
constexpr Time kBefore = 500ms;
constexpr Time kBeyond = 2s;
constexpr Time kSeekTakes = 3s;

constexpr Time kIdle = 1s; ///< between questions while nothing plays
constexpr Time kLongestSilence = 5s;

constexpr std::int64_t kMostPlayers = 1000;
constexpr double kMostSpeed = 64;

/// Hours, minutes, seconds and milliseconds.
std::optional<Time>
read_time(JsonObject *fields)
{
  constexpr struct
  {
    const char *name;
    std::int64_t most;
    Time unit;
  } kParts[] = { { "hours", 99, 1h },
                 { "minutes", 59, 1min },
                 { "seconds", 59, 1s },
                 { "milliseconds", 999, 1ms } };
  Time time{ 0 };
  for (const auto &[name, most, unit] : kParts) {
    const std::optional<std::int64_t> number = json::integer(fields, name, 0, most);
    if (!number)
      return std::nullopt;
    time += *number * unit;
  }
  return time;
}

std::optional<double>
read_speed(JsonObject *fields)
{
  const std::optional<double> speed = json::number(fields, "speed");
  return speed && std::abs(*speed) <= kMostSpeed ? speed : std::nullopt;
}

Time
shown(Time position)
{
  return position + kPictureAhead;
}

} // namespace

std::string
KodiConversation::ping()
{
  return R"({"jsonrpc":"2.0","id":0,"method":"JSONRPC.Ping"})";
}

bool
KodiConversation::is_pong(std::string_view object)
{
  g_autoptr(JsonParser) parser = json::parse(object);
  JsonNode *root = parser != nullptr ? json_parser_get_root(parser) : nullptr;
  return root != nullptr && JSON_NODE_HOLDS_OBJECT(root)
         && json::text(json_node_get_object(root), "result") == "pong";
}

std::string
KodiConversation::question(const char *method, const std::string &parameters, std::int64_t &id)
{
  id = ++last_id_;
  return R"({"jsonrpc":"2.0","id":)" + std::to_string(id) + R"(,"method":")" + method + "\""
         + (parameters.empty() ? "" : ",\"params\":{" + parameters + "}") + "}";
}

std::string
KodiConversation::begin(Time now)
{
  awaited_ = {}; // answers that are on their way are of before
  asked_ = now;
  return question("Player.GetActivePlayers", "", awaited_.players);
}

std::string
KodiConversation::ask_for_item()
{
  return question("Player.GetItem",
                  "\"playerid\":" + std::to_string(*player_) + R"(,"properties":["file"])",
                  awaited_.item);
}

std::string
KodiConversation::ask_for_position(Time now)
{
  asked_ = now;
  return question("Player.GetProperties",
                  "\"playerid\":" + std::to_string(*player_) + R"(,"properties":["time","speed"])",
                  awaited_.properties);
}

bool
KodiConversation::awaits() const
{
  return awaited_.players != 0 || awaited_.item != 0 || awaited_.properties != 0;
}

std::string
KodiConversation::ask(Time now)
{
  if (awaits())
    return {};
  if (player_ && speed_ != 0)
    return ask_for_position(now);
  return now - asked_ >= kIdle ? begin(now) : std::string();
}

bool
KodiConversation::is_silent(Time now) const
{
  return awaits() && now - asked_ > kLongestSilence;
}

KodiConversation::Heard
KodiConversation::received(std::string_view object, Time now)
{
  g_autoptr(JsonParser) parser = json::parse(object);
  JsonNode *root = parser != nullptr ? json_parser_get_root(parser) : nullptr;
  if (root == nullptr || !JSON_NODE_HOLDS_OBJECT(root))
    return {};
  JsonObject *fields = json_node_get_object(root);
  if (const std::string method = json::text(fields, "method"); !method.empty())
    return told(method, json::object(json::object(fields, "params"), "data"), now);
  return answered(json::integer(fields, "id").value_or(0), fields, now);
}

/// Queries anew which player plays what: the report may come from a player of music.
KodiConversation::Heard
KodiConversation::told(const std::string &what, JsonObject *fields, Time now)
{
  constexpr std::array kKnown
      = { "Player.OnPlay",   "Player.OnAVStart",      "Player.OnAVChange", "Player.OnPause",
          "Player.OnResume", "Player.OnSpeedChanged", "Player.OnSeek",     "Player.OnStop" };
  if (std::ranges::find(kKnown, what) == kKnown.end())
    return {};
  Heard heard{ .questions = begin(now) };
  JsonObject *player = json::object(fields, "player");
  const bool is_ours = player_ && json::integer(player, "playerid") == player_;
  if (is_ours && what == "Player.OnPlay") {
    film_.clear();
  } else if (is_ours && what == "Player.OnSeek") {
    take_seek(player, now);
  } else if (is_ours && what == "Player.OnPause") {
    speed_ = 0;
  } else {
    return heard;
  }
  heard.report = report(now);
  return heard;
}

void
KodiConversation::take_seek(JsonObject *player, Time now)
{
  sought_ = true;
  if (const std::optional<Time> to = read_time(json::object(player, "time")))
    seek_ = { .at = now, .to = *to };
}

KodiConversation::Heard
KodiConversation::answered(std::int64_t id, JsonObject *fields, Time now)
{
  if (id <= 0)
    return {};
  if (id == awaited_.players) {
    awaited_.players = 0;
    return has_players(fields, now);
  }
  if (id == awaited_.item) {
    awaited_.item = 0;
    JsonObject *item = json::object(json::object(fields, "result"), "item");
    film_ = json::name_of_file(item, "file");
    if (film_.empty())
      film_ = json::name_of_file(item, "label");
    return { .report = report(now) };
  }
  if (id == awaited_.properties) {
    awaited_.properties = 0;
    return has_properties(json::object(fields, "result"), now);
  }
  return {};
}

KodiConversation::Heard
KodiConversation::has_players(JsonObject *fields, Time now)
{
  player_.reset();
  JsonArray *players = json::array(fields, "result");
  for (guint i = 0; players != nullptr && i < json_array_get_length(players) && !player_; i++) {
    JsonObject *one = json::object(players, i);
    if (json::text(one, "type") == "video")
      player_ = json::integer(one, "playerid", 0, kMostPlayers);
  }
  if (!player_)
    return is_over(now);
  const std::string item = ask_for_item();
  return { .questions = item + ask_for_position(now) };
}

KodiConversation::Heard
KodiConversation::is_over(Time now)
{
  player_.reset();
  film_.clear();
  seek_.reset();
  sought_ = false;
  speed_ = 0;
  return { .report = report(now) };
}

KodiConversation::Heard
KodiConversation::has_properties(JsonObject *fields, Time now)
{
  const std::optional<double> speed = read_speed(fields);
  const std::optional<Time> position = read_time(json::object(fields, "time"));
  if (!speed || !position) // an error: the player is no more
    return is_over(now);
  speed_ = *speed;
  if (seek_ && is_of_before(*position, now))
    return {};
  seek_.reset();
  Report report = this->report(now);
  report.asked = asked_;
  report.position = shown(*position);
  report.sought = std::exchange(sought_, false);
  return { .report = report };
}

bool
KodiConversation::is_of_before(Time position, Time now) const
{
  return now - seek_->at < kSeekTakes
         && (position < seek_->to - kBefore || position > seek_->to + kBeyond);
}

Report
KodiConversation::report(Time now) const
{
  const bool is_open = player_ && !film_.empty();
  return { .received = now,
           .doing = !is_open      ? Doing::stopped
                    : speed_ == 0 ? Doing::paused
                    : seek_       ? Doing::stalled
                                  : Doing::playing,
           .rate = speed_ == 0 ? 1 : speed_,
           .sought = sought_,
           .film = is_open ? film_ : std::string() };
}

} // namespace follow
