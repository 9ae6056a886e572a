// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <vector>

namespace tactor {

/// Folders of the kernel and udev; tests have others.
struct SystemRoots
{
  std::filesystem::path sys = "/sys";
  std::filesystem::path proc = "/proc";
  std::filesystem::path locks = "/run/lock";
  std::filesystem::path udev_data = "/run/udev/data";
  /// Folders of udev's rules.
  std::vector<std::filesystem::path> rules
      = { "/etc/udev/rules.d", "/run/udev/rules.d", "/usr/local/lib/udev/rules.d",
          "/usr/lib/udev/rules.d", "/lib/udev/rules.d" };
};

} // namespace tactor
