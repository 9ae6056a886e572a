// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/websocket/bhaptics_protocol.h"

#include "json/json_reader.h"

#include <algorithm>
#include <cmath>

namespace tactor::bhaptics {

namespace {

constexpr guint kMostPositions = 32;
constexpr guint kMostKeys = 256; ///< of all programs
constexpr std::string_view kKey = "visuotactile-";

std::string
write_key(std::string_view position)
{
  return R"("Key":")" + std::string(kKey) + std::string(position) + '"';
}

std::string
write_frame(const Frame &frame, Time duration)
{
  std::string dots;
  for (std::size_t i = 0; i < frame.intensities.size(); i++)
    if (frame.intensities[i] > 0)
      dots += (dots.empty() ? R"({"Index":)" : R"(,{"Index":)") + std::to_string(i)
              + R"(,"Intensity":)" + std::to_string(frame.intensities[i]) + '}';
  if (dots.empty())
    return R"({"Type":"turnOff",)" + write_key(frame.position) + '}';
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(duration).count();
  return R"({"Type":"frame",)" + write_key(frame.position) + R"(,"Frame":{"Position":")"
         + std::string(frame.position) + R"(","DurationMillis":)" + std::to_string(ms)
         + R"(,"DotPoints":[)" + dots + "]}}";
}

} // namespace

int
intensity(double level)
{
  const auto percent = static_cast<int>(std::lround(std::clamp(level, 0.0, 1.0) * 100));
  return percent == 1 ? 2 : percent;
}

std::string
write_submit(std::span<const Frame> frames, Time duration)
{
  std::string submits;
  for (const Frame &frame : frames)
    submits += (submits.empty() ? "" : ",") + write_frame(frame, duration);
  return R"({"Submit":[)" + submits + "]}";
}

std::optional<Status>
read_status(std::string_view text)
{
  g_autoptr(JsonParser) parser = json::parse(text);
  if (parser == nullptr)
    return std::nullopt;
  JsonNode *root = json_parser_get_root(parser);
  if (!JSON_NODE_HOLDS_OBJECT(root))
    return std::nullopt;
  JsonObject *object = json_node_get_object(root);
  JsonArray *positions = json::array(object, "ConnectedPositions");
  if (positions == nullptr)
    return std::nullopt;
  Status status;
  for (guint i = 0; i < std::min(json_array_get_length(positions), kMostPositions); i++)
    status.positions.push_back(json::text(json_array_get_element(positions, i)));
  JsonArray *keys = json::array(object, "ActiveKeys");
  for (guint i = 0; keys != nullptr && i < std::min(json_array_get_length(keys), kMostKeys); i++)
    if (const std::string key = json::text(json_array_get_element(keys, i));
        key.starts_with(kKey) && status.playing.size() < kMostPositions)
      status.playing.push_back(key.substr(kKey.size()));
  status.is_asleep = json_object_get_boolean_member_with_default(object, "VestIdle", FALSE) != 0;
  return status;
}

} // namespace tactor::bhaptics
