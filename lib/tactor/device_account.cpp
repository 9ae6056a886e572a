// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/device_account.h"

#include <algorithm>
#include <map>
#include <mutex>

namespace tactor {

namespace {

struct Accounts
{
  std::mutex mutex;
  std::map<std::string, std::shared_ptr<DeviceAccount>> of; ///< guarded by the mutex
};

/// Never destroyed: drivers may be released while the process exits.
Accounts &
accounts()
{
  static auto *all = new Accounts;
  return *all;
}

} // namespace

std::shared_ptr<DeviceAccount>
DeviceAccount::of(const std::string &device)
{
  Accounts &all = accounts();
  const std::lock_guard lock(all.mutex);
  std::shared_ptr<DeviceAccount> &account = all.of[device];
  if (!account)
    account = std::make_shared<DeviceAccount>();
  return account;
}

void
DeviceAccount::set_limits(const MotorLimits &limits)
{
  const std::lock_guard lock(mutex_);
  limits_ = limits;
}

void
DeviceAccount::admit(std::span<double> levels, Time now)
{
  const std::lock_guard lock(mutex_);
  motors_.resize(std::max(motors_.size(), levels.size()));
  for (std::size_t i = 0; i < motors_.size(); i++) {
    const double admitted = admit(motors_[i], i < levels.size() ? levels[i] : 0, now);
    if (i < levels.size())
      levels[i] = admitted;
  }
}

/// With the lock.
double
DeviceAccount::admit(Motor &motor, double level, Time now)
{
  MotorUse &use = motor.use;
  motor.next = Time::max();
  if (level <= 0) {
    if (use.is_on())
      use.end(now, false);
    motor.cut_at.reset();
    return 0;
  }
  if (motor.cut_at && now - *motor.cut_at >= kLongestRest)
    motor.cut_at.reset();
  if (motor.cut_at || (!use.is_on() && now < use.ready_at())) {
    motor.next = motor.cut_at ? *motor.cut_at + kLongestRest : use.ready_at();
    return 0;
  }
  const Time end = use.latest_end(use.is_on() ? use.on_since() : now, limits_).time;
  const Time latest = end > Time::max() - kGrace ? end : end + kGrace;
  // A tactor without time left does not begin for the sake of the grace.
  if (now < (use.is_on() ? latest : end)) {
    if (!use.is_on())
      use.begin(now);
    motor.next = latest;
    return level;
  }
  if (use.is_on())
    use.end(now, true);
  motor.cut_at = now;
  motor.next = now + kLongestRest;
  cuts_++;
  return 0;
}

std::optional<Time>
DeviceAccount::deadline() const
{
  const std::lock_guard lock(mutex_);
  Time next = Time::max();
  for (const Motor &motor : motors_)
    next = std::min(next, motor.next);
  return next == Time::max() ? std::nullopt : std::optional(next);
}

std::vector<MotorUse>
DeviceAccount::uses(Time now) const
{
  const std::lock_guard lock(mutex_);
  std::vector<MotorUse> uses;
  for (const Motor &motor : motors_) {
    uses.push_back(motor.use);
    uses.back().forget_from(now);
  }
  return uses;
}

std::uint64_t
DeviceAccount::cuts() const
{
  const std::lock_guard lock(mutex_);
  return cuts_;
}

} // namespace tactor
