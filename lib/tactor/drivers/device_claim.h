// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>

namespace tactor {

/// Devices that one driver of this process has, and no other, for as long as this object lives.
/// Any thread.
class DeviceClaim
{
public:
  /// Without an object if another claim has one of the devices.
  static std::optional<DeviceClaim> make(std::set<std::string> devices);
  ~DeviceClaim();
  DeviceClaim(DeviceClaim &&other) noexcept : devices_(std::exchange(other.devices_, {}))
  {
  }
  DeviceClaim &operator=(DeviceClaim &&) = delete;

private:
  explicit DeviceClaim(std::set<std::string> devices);

  std::set<std::string> devices_;
};

} // namespace tactor
