// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/threaded_driver.h"

#include "tactor/unlocked.h"

#include <algorithm>
#include <utility>

namespace tactor {

tl::expected<void, DriverError>
ThreadedDriver::open(const DriverConfig &config)
{
  close();
  {
    const std::lock_guard lock(mutex_);
    config_ = config;
    quit_ = was_left_ = false;
    refusal_.reset();
    status_ = {};
    levels_.clear();
    account_.reset();
    is_new_ = false;
    reset();
    runs_ = true;
  }
  guard_ = std::make_unique<TerminationGuard>([this](auto until) { leave(until); },
                                              [this] { stay(); });
  const std::stop_callback stopped(config.stop, [this] { quit(Lock(mutex_)); });
  std::optional<DriverError> refusal;
  tl::expected<Thread, DriverError> thread = Thread::start([this] {
    Lock lock(mutex_);
    run(lock);
    runs_ = false;
    changed_.notify_all();
  });
  if (thread) {
    thread_ = std::move(*thread);
    Lock lock(mutex_);
    changed_.wait(lock, [this] { return is_open_ || refusal_; });
    refusal = refusal_;
  } else {
    const std::lock_guard lock(mutex_);
    runs_ = false;
    refusal = thread.error();
  }
  if (!refusal)
    return {};
  close();
  return tl::unexpected(*refusal);
}

int
ThreadedDriver::tactors() const
{
  const std::lock_guard lock(mutex_);
  return tactors_;
}

void
ThreadedDriver::close() noexcept
{
  quit(Lock(mutex_));
  thread_.join();
  guard_.reset(); // without the lock, which leave() takes
  const std::lock_guard lock(mutex_);
  is_open_ = status_.is_there = false;
  tactors_ = 0;
}

tl::expected<void, DriverError>
ThreadedDriver::write(std::span<const double> volts, Time)
{
  const std::lock_guard lock(mutex_);
  if (was_left_)
    return tl::unexpected(
        DriverError{ DriverError::Kind::failed,
                     status_.board
                         + " was released, as a signal was about to end the process, and then the "
                           "application handled that; stop the film and play it again" });
  std::vector<double> levels;
  const auto used = std::min(volts.size(), static_cast<std::size_t>(tactors_));
  for (std::size_t i = 0; i < used; i++) // NaN is 0
    levels.push_back(volts[i] > 0 ? std::min(volts[i] / config_.full_scale_volts, 1.0) : 0.0);
  status_.overtaken += is_new_ && status_.is_there && levels != levels_;
  levels_ = std::move(levels);
  written_at_ = steady_now();
  is_new_ = true;
  changed_.notify_all();
  levels_written();
  return {};
}

DriverStatus
ThreadedDriver::status() const
{
  const std::lock_guard lock(mutex_);
  return status_now();
}

DriverStatus
ThreadedDriver::status_now() const
{
  DriverStatus status = status_;
  status.cuts = account_ ? account_->cuts() - cuts_before_ : 0;
  return status;
}

std::shared_ptr<DeviceAccount>
ThreadedDriver::account() const
{
  const std::lock_guard lock(mutex_);
  return account_;
}

void
ThreadedDriver::use_account(const std::string &device)
{
  const std::shared_ptr<DeviceAccount> account = DeviceAccount::of(device);
  if (account == account_)
    return; // its limits may have changed since
  account_ = account;
  account_->set_limits(config_.limits);
  cuts_before_ = account_->cuts();
}

bool
ThreadedDriver::has_new_levels(Time now) const
{
  const std::optional<Time> end = levels_end();
  return is_new_ || (end && now >= *end);
}

std::vector<double>
ThreadedDriver::levels(Time now)
{
  is_new_ = false;
  std::vector<double> levels = levels_;
  if (account_)
    account_->admit(levels, now);
  return levels;
}

std::optional<Time>
ThreadedDriver::levels_end() const
{
  return account_ ? account_->deadline() : std::nullopt;
}

void
ThreadedDriver::stand()
{
  is_new_ = true; // for the next device
  if (account_)
    account_->admit({}, steady_now());
}

void
ThreadedDriver::opened()
{
  is_open_ = true;
  changed_.notify_all();
}

void
ThreadedDriver::refuse(const DriverError &error)
{
  refusal_ = error;
  changed_.notify_all();
}

void
ThreadedDriver::tell(Lock &lock, DriverEvent::Kind kind, const std::string &text)
{
  if (!config_.notify)
    return;
  const Unlocked unlocked(lock);
  config_.notify({ kind, text });
}

/// Has the thread stop the motors, release the device and end. Any thread.
void
ThreadedDriver::quit(Lock lock)
{
  quit_ = true;
  changed_.notify_all();
  wake(lock);
}

/// Motors to zero and the device released, by `until` at the latest, even if the mutex is held. On
/// TerminationGuard's thread.
void
ThreadedDriver::leave(std::chrono::steady_clock::time_point until)
{
  if (Lock lock(mutex_, until); lock)
    quit(std::move(lock));
  if (Lock lock(mutex_, until); lock)
    changed_.wait_until(lock, until, [this] { return !runs_; });
}

/// After leave(). On the same thread.
void
ThreadedDriver::stay()
{
  const std::lock_guard lock(mutex_);
  was_left_ = quit_;
  status_.is_there = false;
}

} // namespace tactor
