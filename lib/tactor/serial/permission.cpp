// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/serial/permission.h"

#include "tactor/serial/small_file.h"

#include <algorithm>
#include <fstream>
#include <system_error>

namespace tactor {

namespace {

constexpr const char *kRule = "70-visuotactile.rules"; // data/udev
constexpr const char *kApply
    = "sudo udevadm control --reload && sudo udevadm trigger --subsystem-match=usb";

/// Whether udev grants the device to the user of the local session: the tag "Q:uaccess" in its
/// database (since udev 247; "G:uaccess" before).
bool
is_marked(const std::string &bus_path, const SystemRoots &roots)
{
  const std::string number = small_file(roots.sys / "bus/usb/devices" / bus_path / "dev");
  std::ifstream known(roots.udev_data / ("c" + number));
  bool marked = false;
  for (std::string line; !marked && std::getline(known, line);)
    marked = line == "Q:uaccess" || line == "G:uaccess";
  return marked;
}

} // namespace

std::string
permission_advice(const std::string &bus_path, const SystemRoots &roots)
{
  if (is_marked(bus_path, roots))
    return "the udev rule gives it to the user at the computer, and you are not (ssh, a "
           "service, "
           "another user's session): log in at the computer itself, or let a group use boards: "
           "echo "
           "'ENV{VISUOTACTILE_BOARD}==\"1\", GROUP=\"plugdev\", MODE=\"0660\"' | sudo tee "
           "/etc/udev/rules.d/71-visuotactile-group.rules && "
           + std::string(kApply) + " && sudo usermod -aG plugdev \"$USER\", then log in again";
  const bool is_installed = std::ranges::any_of(roots.rules, [](const auto &folder) {
    std::error_code error;
    return std::filesystem::exists(folder / kRule, error);
  });
  if (is_installed)
    return "the udev rule (" + std::string(kRule) + ") is installed, but was not applied to it: "
           + kApply + ", or plug it out and in again";
  return "install the udev rule: sudo install -m 644 data/udev/" + std::string(kRule)
         + " /etc/udev/rules.d/ && " + kApply;
}

} // namespace tactor
