// SPDX-License-Identifier: LGPL-2.1-or-later
#include "house/missing.h"

#include "tactor/drivers/last_device.h"
#include "translation.h"

#include <glib.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string_view>
#include <unistd.h>

namespace {

struct Server
{
  const char *driver;
  unsigned port;
};

constexpr std::array kServers = { Server{ "bhaptics", 15881 }, Server{ "intiface", 12345 } };
constexpr unsigned kListens = 0x0A; // TCP_LISTEN of the kernel

/// The ports on which this computer listens, by the kernel's table.
std::vector<unsigned>
listening_ports(const std::filesystem::path &table)
{
  std::vector<unsigned> ports;
  std::ifstream file(table);
  for (std::string line; std::getline(file, line);) {
    std::istringstream fields(line);
    std::string number;
    std::string local;
    std::string remote;
    unsigned state = 0;
    unsigned port = 0;
    if (fields >> number >> local >> remote >> std::hex >> state && state == kListens
        && std::sscanf(local.c_str(), "%*[0-9A-F]:%x", &port) == 1)
      ports.push_back(port);
  }
  return ports;
}

unsigned
number_in(const std::filesystem::path &path)
{
  unsigned number = 0;
  std::ifstream(path) >> number;
  return number;
}

/// The device file of a board; empty if there is none.
std::filesystem::path
node_of(const FoundDevice &device, const System &system)
{
  if (device.bus_path.empty())
    return device.driver == "gamepad" && device.device.starts_with('/')
               ? system.root / device.device.substr(1)
               : "";
  const auto folder = system.root / "sys/bus/usb/devices" / device.bus_path;
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "%03u/%03u", number_in(folder / "busnum"),
                number_in(folder / "devnum"));
  return system.root / "dev/bus/usb" / name.data();
}

bool
has_module(const System &system, const std::string &name)
{
  const char *set = g_getenv("VISUOTACTILE_MODULES");
  const std::filesystem::path folder = !system.modules.empty() ? system.modules
                                       : set != nullptr        ? set
                                                               : MODULES;
  std::error_code error;
  return std::filesystem::exists(folder / ("visuotactile-" + name + ".so"), error);
}

bool
is_refused(const std::filesystem::path &node)
{
  return !node.empty() && access(node.c_str(), F_OK) == 0 && access(node.c_str(), R_OK | W_OK) != 0;
}

} // namespace

std::vector<std::string>
waiting_servers(const System &system)
{
  std::vector<unsigned> ports = listening_ports(system.root / "proc/net/tcp");
  const std::vector<unsigned> more = listening_ports(system.root / "proc/net/tcp6");
  ports.insert(ports.end(), more.begin(), more.end());
  std::vector<std::string> drivers;
  for (const Server &server : kServers)
    if (std::ranges::find(ports, server.port) != ports.end())
      drivers.emplace_back(server.driver);
  return drivers;
}

std::optional<FoundDevice>
absent_device(const std::vector<FoundDevice> &found, const std::vector<std::string> &servers)
{
  const std::optional<tactor::LastDevice> last = tactor::last_device();
  const auto is_it = [&last](const FoundDevice &device) {
    return device.driver == last->driver
           && (last->device.empty() || last->device == device.device
               || last->device == device.name);
  };
  // A board of driver=auto has the row of that driver.
  if (!last || last->driver == "auto" || std::ranges::find(servers, last->driver) != servers.end()
      || std::ranges::any_of(found, is_it))
    return std::nullopt;
  return FoundDevice{ .name = in_text("{}, not connected now", last->board),
                      .driver = last->driver,
                      .device = last->device };
}

std::vector<std::string>
missing(const std::vector<FoundDevice> &found, const System &system)
{
  std::vector<std::string> lines;
  const auto is_chair = [](const FoundDevice &device) {
    return device.driver != kAudio;
  };
  for (const FoundDevice &device : found) {
    const bool is_gamepad = device.driver == "gamepad";
    if (is_gamepad && !has_module(system, "gamepad"))
      lines.push_back(in_text("{} needs the package gstreamer1.0-visuotactile-gamepad: install it.",
                              device.name));
    if (!is_refused(node_of(device, system)))
      continue;
    lines.push_back(
        is_gamepad
            ? in_text("{} may not be used from here: log in at the computer itself.", device.name)
            : in_text("{} may not be opened: install the package gstreamer1.0-visuotactile, whose "
                      "udev rule grants it to you, and plug it out and in again.",
                      device.name));
  }
  const std::vector<std::string> servers = waiting_servers(system);
  for (const std::string &server : servers)
    if (!has_module(system, "websocket"))
      lines.push_back(in_text("{} needs the package gstreamer1.0-visuotactile-websocket: install "
                              "it.",
                              server));
  if (std::ranges::none_of(found, is_chair) && servers.empty())
    lines.emplace_back(_("No device is connected: plug in a board or a gamepad, or start bHaptics "
                         "Player or Intiface."));
  return lines;
}
