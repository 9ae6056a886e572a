// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/device_claim.h"

#include <algorithm>
#include <mutex>

namespace tactor {

namespace {

struct Claimed
{
  std::mutex mutex;
  std::set<std::string> devices; ///< guarded by the mutex
};

/// Never destroyed: drivers may be released while the process exits.
Claimed &
claimed()
{
  static auto *all = new Claimed;
  return *all;
}

} // namespace

std::optional<DeviceClaim>
DeviceClaim::make(std::set<std::string> devices)
{
  Claimed &all = claimed();
  const std::lock_guard lock(all.mutex);
  if (std::ranges::any_of(devices,
                          [&](const std::string &device) { return all.devices.contains(device); }))
    return std::nullopt;
  all.devices.insert(devices.begin(), devices.end());
  return DeviceClaim(std::move(devices));
}

DeviceClaim::DeviceClaim(std::set<std::string> devices) : devices_(std::move(devices))
{
}

DeviceClaim::~DeviceClaim()
{
  if (devices_.empty()) // also while make() has the lock, and returns
    return;
  Claimed &all = claimed();
  const std::lock_guard lock(all.mutex);
  for (const std::string &device : devices_)
    all.devices.erase(device);
}

} // namespace tactor
