// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/threaded_driver.h"

#include "tactor/unlocked.h"

#include <utility>

namespace tactor {

tl::expected<void, DriverError>
ThreadedDriver::open(const DriverConfig &config)
{
  close();
  {
    const std::lock_guard lock(mutex_);
    config_ = config;
    quit_ = false;
    refusal_.reset();
    status_ = {};
    reset();
    runs_ = true;
  }
  guard_ = std::make_unique<TerminationGuard>([this](auto until) { leave(until); });
  const std::stop_callback stopped(config.stop, [this] { quit(); });
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
  quit();
  thread_.join();
  guard_.reset(); // without the lock, which leave() takes
  const std::lock_guard lock(mutex_);
  is_open_ = status_.is_there = false;
  tactors_ = 0;
}

DriverStatus
ThreadedDriver::status() const
{
  const std::lock_guard lock(mutex_);
  return status_;
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
ThreadedDriver::quit()
{
  {
    const std::lock_guard lock(mutex_);
    quit_ = true;
    changed_.notify_all();
  }
  wake();
}

/// Motors to zero and the device released, by `until` at the latest. On TerminationGuard's thread.
void
ThreadedDriver::leave(std::chrono::steady_clock::time_point until)
{
  quit();
  Lock lock(mutex_);
  changed_.wait_until(lock, until, [this] { return !runs_; });
}

} // namespace tactor
