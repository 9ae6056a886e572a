// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/driver.h"
#include "tactor/termination.h"
#include "tactor/thread.h"

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>

namespace tactor {

/// A driver with a thread of its own, which alone has the device: it finds it, sends it the newest
/// levels, and looks for it when it is lost. write() leaves the levels to it and never waits.
///
/// If a signal or exit() ends the process, the thread stops the motors first: see TerminationGuard.
class ThreadedDriver : public Driver
{
public:
  [[nodiscard]] tl::expected<void, DriverError> open(const DriverConfig &config) final;
  int tactors() const final;
  /// The destructor of each derived class calls it.
  void close() noexcept final;
  DriverStatus status() const override;

protected:
  using Lock = std::unique_lock<std::mutex>;

  /// On the thread, with the lock, which it releases while it waits, uses the device or tells.
  /// Calls opened() or refuse() once, and returns soon after quit_ is set, with motors at zero and
  /// the device released.
  virtual void run(Lock &lock) = 0;
  /// Forgets the last play. With the lock, without a thread.
  virtual void reset() = 0;
  /// quit_ was set: ends what run() waits for besides changed_. Without the lock; any thread.
  virtual void wake()
  {
  }

  void opened();                         ///< with the lock
  void refuse(const DriverError &error); ///< why open() fails; with the lock
  /// Calls DriverConfig::notify. Releases the lock meanwhile.
  void tell(Lock &lock, DriverEvent::Kind kind, const std::string &text);
  static Time steady_now()
  {
    return std::chrono::steady_clock::now().time_since_epoch();
  }

  mutable std::mutex mutex_; ///< guards everything below, and what derived classes say
  std::condition_variable changed_;
  DriverConfig config_;
  bool is_open_ = false;
  bool quit_ = false;
  int tactors_ = 0;
  DriverStatus status_;

private:
  void quit();
  void leave(std::chrono::steady_clock::time_point until);

  bool runs_ = false;                  ///< the thread has the device; guarded by the mutex
  std::optional<DriverError> refusal_; ///< guarded by the mutex

  // Of the thread that opens and closes
  Thread thread_;
  std::unique_ptr<TerminationGuard> guard_; ///< from the beginning of open() to the end of close()
};

} // namespace tactor
