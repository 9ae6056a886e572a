// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace tactor {

/// A device that answered, to offer it while it is not connected.
struct LastDevice
{
  std::string driver;
  std::string device; ///< DriverConfig::device; empty: the first that answers
  std::string board;  ///< DriverStatus::board

  bool operator==(const LastDevice &) const = default;
};

/// $XDG_STATE_HOME/visuotactile/FILE, by default in ~/.local/state; empty without either.
std::filesystem::path state_file(const char *file);

/// The last one. Nothing if the file has other lines than driver, device and board.
std::optional<LastDevice> last_device(const std::filesystem::path &file = state_file("device"));

/// Errors of the file are ignored. Any thread.
void remember_device(const LastDevice &device,
                     const std::filesystem::path &file = state_file("device"));

} // namespace tactor
