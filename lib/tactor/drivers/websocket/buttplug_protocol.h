// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// Messages of the Buttplug protocol, versions 3 and 4 (https://docs.buttplug.io/docs/spec).
namespace tactor::buttplug {

inline constexpr int kPort = 12345; ///< of Intiface
inline constexpr int kOldest = 3;
inline constexpr int kNewest = 4;
/// More steps of an output than this are not believed.
inline constexpr int kMostSteps = 100'000;

using Id = std::uint32_t;

struct Vibrator
{
  Id index = 0;
  int steps = 1; ///< 1…kMostSteps; level 1 is the last one
  bool operator==(const Vibrator &) const = default;
};

struct Device
{
  Id index = 0;
  std::string name;
  std::string display_name;  ///< given by the user; empty if none
  std::optional<Time> gap{}; ///< the shortest one between commands, if it is known
  std::vector<Vibrator> vibrators{};
  bool operator==(const Device &) const = default;
};

struct ServerInfo
{
  std::string name;
  int version = 0;
  Time max_ping_time{ 0 }; ///< 0: it requires no pings
};
struct Ok
{
  Id id = 0;
};
struct Error
{
  Id id = 0; ///< 0: of no message in particular
  std::string text;
};
struct DeviceList
{
  std::vector<Device> devices;
};
struct DeviceRemoved
{
  Id index = 0;
};
using Message = std::variant<ServerInfo, Ok, Error, DeviceList, DeviceRemoved>;

/// The messages of a text that are known, of any version. None if it is none of the protocol.
std::optional<std::vector<Message>> read_messages(std::string_view text);

std::string write_request_server_info(Id id, int version);
std::string write_request_device_list(Id id);
std::string write_ping(Id id);
/// All outputs of a device to zero.
std::string write_stop(Id id, Id device, int version);

struct Value
{
  Vibrator vibrator;
  int value = 0; ///< 0…steps
};
/// Messages that such a text has, with Ids from `id` on.
Id count_commands(std::size_t values, int version);
/// Sets vibrators of a device, at least one.
std::string write_values(Id id, Id device, std::span<const Value> values, int version);

} // namespace tactor::buttplug
