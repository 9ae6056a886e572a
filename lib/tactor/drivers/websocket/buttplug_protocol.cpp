// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/websocket/buttplug_protocol.h"

#include "json/json_reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>

namespace tactor::buttplug {

namespace {

constexpr guint kMostMessages = 64;  ///< of a text
constexpr guint kMostDevices = 64;   ///< of a list
constexpr guint kMostVibrators = 64; ///< of a device
constexpr std::int64_t kMostId = std::numeric_limits<Id>::max();
/// Longer times are no gaps between commands, and no intervals of pings.
constexpr Time kLongestGap = std::chrono::seconds(2);
constexpr Time kLongestPing = std::chrono::hours(1);

std::optional<Id>
read_id(JsonObject *of, const char *name)
{
  const auto id = json::integer(of, name, 0, kMostId);
  return id ? std::optional(static_cast<Id>(*id)) : std::nullopt;
}

/// A time in ms; longer ones are `longest`.
std::optional<Time>
read_time(JsonObject *of, const char *name, Time longest)
{
  const auto ms = json::integer(of, name);
  if (!ms || *ms < 0)
    return std::nullopt;
  const auto most = std::chrono::duration_cast<std::chrono::milliseconds>(longest).count();
  return std::chrono::milliseconds(std::min<std::int64_t>(*ms, most));
}

/// Version 3: an array of attributes, where the place of one is its index.
void
read_scalars(JsonObject *messages, std::vector<Vibrator> &vibrators)
{
  JsonArray *scalars = json::array(messages, "ScalarCmd");
  const guint count = scalars != nullptr ? json_array_get_length(scalars) : 0;
  for (guint i = 0; i < count && vibrators.size() < kMostVibrators; i++) {
    JsonObject *scalar = json::object(scalars, i);
    const auto steps = json::integer(scalar, "StepCount", 1, kMostSteps);
    if (steps && json::text(scalar, "ActuatorType") == "Vibrate")
      vibrators.push_back({ .index = i, .steps = static_cast<int>(*steps) });
  }
}

/// Version 4: an object of features, of which each has its index and the ranges of its outputs.
void
read_features(JsonObject *features, std::vector<Vibrator> &vibrators)
{
  g_autoptr(GList) members = features != nullptr ? json_object_get_members(features) : nullptr;
  for (GList *member = members; member != nullptr && vibrators.size() < kMostVibrators;
       member = member->next) {
    JsonObject *feature = json::object(features, static_cast<const char *>(member->data));
    const std::optional<Id> index = read_id(feature, "FeatureIndex");
    JsonObject *output = json::object(json::object(feature, "Output"), "Vibrate");
    JsonArray *range = json::array(output, "Value");
    if (!index || range == nullptr || json_array_get_length(range) != 2)
      continue;
    JsonNode *last = json_array_get_element(range, 1);
    if (!JSON_NODE_HOLDS_VALUE(last) || json_node_get_value_type(last) != G_TYPE_INT64)
      continue;
    const std::int64_t steps = json_node_get_int(last);
    if (steps >= 1 && steps <= kMostSteps)
      vibrators.push_back({ .index = *index, .steps = static_cast<int>(steps) });
  }
  std::ranges::sort(vibrators, {}, &Vibrator::index);
}

std::optional<Device>
read_device(JsonObject *object)
{
  const std::optional<Id> index = read_id(object, "DeviceIndex");
  if (!index)
    return std::nullopt;
  Device device{ .index = *index,
                 .name = json::text(object, "DeviceName"),
                 .display_name = json::text(object, "DeviceDisplayName"),
                 .gap = read_time(object, "DeviceMessageTimingGap", kLongestGap) };
  read_scalars(json::object(object, "DeviceMessages"), device.vibrators);
  if (device.vibrators.empty())
    read_features(json::object(object, "DeviceFeatures"), device.vibrators);
  return device;
}

/// An array in version 3, an object in version 4.
DeviceList
read_devices(JsonObject *object)
{
  DeviceList list;
  const auto add = [&](JsonObject *device) {
    if (std::optional<Device> read = read_device(device);
        read && list.devices.size() < kMostDevices)
      list.devices.push_back(std::move(*read));
  };
  if (JsonArray *devices = json::array(object, "Devices"))
    for (guint i = 0; i < json_array_get_length(devices); i++)
      add(json::object(devices, i));
  if (JsonObject *devices = json::object(object, "Devices")) {
    g_autoptr(GList) members = json_object_get_members(devices);
    for (GList *member = members; member != nullptr; member = member->next)
      add(json::object(devices, static_cast<const char *>(member->data)));
  }
  std::ranges::sort(list.devices, {}, &Device::index);
  return list;
}

std::optional<Message>
read_message(std::string_view type, JsonObject *fields)
{
  const std::optional<Id> id = read_id(fields, "Id");
  if (!id)
    return std::nullopt;
  if (type == "Ok")
    return Ok{ *id };
  if (type == "Error")
    return Error{ *id, json::text(fields, "ErrorMessage") };
  if (type == "DeviceList")
    return read_devices(fields);
  if (type == "DeviceRemoved") {
    const std::optional<Id> index = read_id(fields, "DeviceIndex");
    return index ? std::optional<Message>(DeviceRemoved{ *index }) : std::nullopt;
  }
  if (type == "ServerInfo") {
    const auto major = json::integer(fields, "ProtocolVersionMajor", 0, 1000);
    const auto version = major ? major : json::integer(fields, "MessageVersion", 0, 1000);
    return ServerInfo{ .name = json::text(fields, "ServerName"),
                       .version = static_cast<int>(version.value_or(0)),
                       .max_ping_time
                       = read_time(fields, "MaxPingTime", kLongestPing).value_or(Time(0)) };
  }
  return std::nullopt;
}

/// [{"TYPE":{"Id":ID MORE}}], without brackets.
std::string
write_message(std::string_view type, Id id, const std::string &more)
{
  return R"({")" + std::string(type) + R"(":{"Id":)" + std::to_string(id) + more + "}}";
}

std::string
write_array(const std::string &messages)
{
  return '[' + messages + ']';
}

std::string
write_scalar(double value)
{
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                 std::chars_format::fixed);
  return { digits.data(), end.ptr };
}

} // namespace

std::optional<std::vector<Message>>
read_messages(std::string_view text)
{
  g_autoptr(JsonParser) parser = json::parse(text);
  if (parser == nullptr || !JSON_NODE_HOLDS_ARRAY(json_parser_get_root(parser)))
    return std::nullopt;
  JsonArray *array = json_node_get_array(json_parser_get_root(parser));
  std::vector<Message> messages;
  for (guint i = 0; i < std::min(json_array_get_length(array), kMostMessages); i++) {
    JsonObject *message = json::object(array, i);
    if (message == nullptr || json_object_get_size(message) != 1)
      continue;
    g_autoptr(GList) types = json_object_get_members(message);
    const auto *type = static_cast<const char *>(types->data);
    if (std::optional<Message> read = read_message(type, json::object(message, type)))
      messages.push_back(std::move(*read));
  }
  return messages;
}

std::string
write_request_server_info(Id id, int version)
{
  const std::string versions = version >= 4
                                   ? R"(,"ProtocolVersionMajor":4,"ProtocolVersionMinor":0)"
                                   : R"(,"MessageVersion":)" + std::to_string(version);
  return write_array(
      write_message("RequestServerInfo", id, R"(,"ClientName":"visuotactile")" + versions));
}

std::string
write_request_device_list(Id id)
{
  return write_array(write_message("RequestDeviceList", id, ""));
}

std::string
write_ping(Id id)
{
  return write_array(write_message("Ping", id, ""));
}

std::string
write_stop(Id id, Id device, int version)
{
  const std::string index = R"(,"DeviceIndex":)" + std::to_string(device);
  if (version >= 4)
    return write_array(write_message("StopCmd", id, index + R"(,"Inputs":false,"Outputs":true)"));
  return write_array(write_message("StopDeviceCmd", id, index));
}

Id
count_commands(std::size_t values, int version)
{
  return version >= 4 ? static_cast<Id>(values) : 1;
}

std::string
write_values(Id id, Id device, std::span<const Value> values, int version)
{
  const std::string index = R"(,"DeviceIndex":)" + std::to_string(device);
  std::string text;
  for (const Value &value : values) {
    const std::string vibrator = std::to_string(value.vibrator.index);
    text += text.empty() ? "" : ",";
    if (version >= 4)
      text += write_message("OutputCmd", id++,
                            index + R"(,"FeatureIndex":)" + vibrator
                                + R"(,"Command":{"Vibrate":{"Value":)" + std::to_string(value.value)
                                + "}}");
    else
      text += R"({"Index":)" + vibrator + R"(,"Scalar":)"
              + write_scalar(static_cast<double>(value.value) / value.vibrator.steps)
              + R"(,"ActuatorType":"Vibrate"})";
  }
  if (version < 4)
    text = write_message("ScalarCmd", id, index + R"(,"Scalars":[)" + text + ']');
  return write_array(text);
}

} // namespace tactor::buttplug
