// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <memory>

namespace chair {

/// Calls `changed`, on a thread of its own, soon after the user's file was changed. The destructor
/// waits for a call that has begun.
class SettingsWatch
{
public:
  explicit SettingsWatch(std::function<void()> changed);
  /// False if the system has no more threads: then no change is noticed.
  bool watches() const;
  ~SettingsWatch();
  SettingsWatch(const SettingsWatch &) = delete;
  SettingsWatch &operator=(const SettingsWatch &) = delete;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

} // namespace chair
