// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow/players/mpv_conversation.h"

#include "json/json_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace follow {

namespace {

constexpr std::array kProperties
    = { "working-directory",   "path",    "seeking", "core-idle", "pause", "speed", "container-fps",
        "video-timing-offset", "time-pos" };

constexpr std::int64_t kLifeSign = 1000;                     ///< number of the question
constexpr Time kUsualOffset = std::chrono::milliseconds(50); ///< video-timing-offset
constexpr Time kMostOffset = std::chrono::seconds(1);

constexpr double kLeastRate = 1; ///< frames a second
constexpr double kMostRate = 1000;
constexpr double kMostSeconds = 100.0 * 3600;

std::optional<Time>
read_time(JsonObject *fields)
{
  const std::optional<double> seconds = json::number(fields, "data");
  if (!seconds || !(*seconds >= 0 && *seconds <= kMostSeconds))
    return std::nullopt;
  return Time(std::llround(*seconds * 1e9));
}

/// The duration of a frame; 0 if there is none.
Time
read_frame(JsonObject *fields)
{
  const double rate = json::number(fields, "data").value_or(0);
  return rate >= kLeastRate && rate <= kMostRate ? Time(std::llround(1e9 / rate)) : Time(0);
}

bool
is_uri(const std::string &path)
{
  return path.find("://") != std::string::npos;
}

} // namespace

MpvConversation::MpvConversation() : earliest_(kUsualOffset)
{
}

std::string
MpvConversation::life_sign()
{
  return R"({"command":["get_property","core-idle"],"request_id":)" + std::to_string(kLifeSign)
         + "}\n";
}

std::string
MpvConversation::questions()
{
  std::string text;
  int id = 0;
  for (const char *property : kProperties)
    text += R"({"command":["observe_property",)" + std::to_string(++id) + ",\"" + property
            + "\"]}\n";
  return text;
}

/// Whether the property is an observed one.
bool
MpvConversation::take(const std::string &property, JsonObject *fields)
{
  if (property == "time-pos")
    position_ = read_time(fields);
  else if (property == "container-fps")
    frame_ = read_frame(fields);
  else if (property == "video-timing-offset")
    earliest_ = std::clamp(read_time(fields).value_or(kUsualOffset), Time(0), kMostOffset);
  else if (property == "path")
    path_ = json::name_of_file(fields, "data");
  else if (property == "working-directory")
    folder_ = json::name_of_file(fields, "data");
  else if (property == "pause")
    paused_ = json::truth(fields, "data").value_or(false);
  else if (property == "core-idle")
    idle_ = json::truth(fields, "data").value_or(true);
  else if (property == "seeking")
    seeking_ = json::truth(fields, "data").value_or(false);
  else if (property == "speed")
    rate_ = json::number(fields, "data").value_or(1);
  else
    return false;
  return true;
}

std::optional<Report>
MpvConversation::received(std::string_view line, Time now)
{
  g_autoptr(JsonParser) parser = json::parse(line);
  JsonNode *root = parser != nullptr ? json_parser_get_root(parser) : nullptr;
  if (root == nullptr || !JSON_NODE_HOLDS_OBJECT(root))
    return std::nullopt;
  JsonObject *fields = json_node_get_object(root);
  const std::string event = json::text(fields, "event");
  if (event == "seek") {
    seeking_ = true;
    sought_ = true;
    told_.reset();
  } else if (event == "playback-restart") {
    seeking_ = false; // mpv may skip notifications of quick changes
  } else if (event == "start-file") {
    ended_ = false;
  } else if (event == "end-file" || event == "shutdown") {
    ended_ = true;
    told_.reset();
  } else if (event.empty() && json::integer(fields, "request_id") == kLifeSign) {
    idle_ = json::truth(fields, "data").value_or(true);
  } else if (event != "property-change" || !take(json::text(fields, "name"), fields)) {
    return std::nullopt;
  }
  Report report{ .received = now, .doing = doing(), .rate = rate_, .film = film() };
  // During a seek, mpv reports the target before it has reached it.
  const std::optional<Time> position = std::exchange(position_, std::nullopt);
  if (report.doing != Doing::stalled)
    report.position = position ? std::optional(shown(*position)) : std::nullopt;
  report.sought = sought_;
  if (report.doing == Doing::playing && report.position)
    sought_ = false;
  return report;
}

/// The position of the film when mpv reports one.
Time
MpvConversation::shown(Time position)
{
  if (const std::optional<Time> before = std::exchange(told_, position);
      before && *before < position)
    frame_ = position - *before;
  const Time most(std::llround(static_cast<double>(earliest_.count()) * rate_));
  return std::max(Time(0), position - std::min(frame_, most));
}

Doing
MpvConversation::doing() const
{
  if (ended_ || path_.empty())
    return Doing::stopped;
  if (seeking_)
    return Doing::stalled;
  if (paused_)
    return Doing::paused;
  return idle_ ? Doing::stalled : Doing::playing;
}

std::string
MpvConversation::film() const
{
  if (ended_)
    return "";
  const bool is_whole = path_.empty() || path_.front() == '/' || is_uri(path_) || folder_.empty();
  return is_whole ? path_ : folder_ + "/" + path_;
}

} // namespace follow
