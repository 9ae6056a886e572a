// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/driver.h"
#include "tactor/priority_mutex.h"
#include "tactor/termination.h"
#include "tactor/thread.h"

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace tactor {

/// A driver with a thread of its own, which alone has the device: it finds it, sends it the newest
/// levels, and looks for it when it is lost. write() leaves the levels to it and never waits. The
/// thread cuts levels that exceed the limits of the device's account, even if another thread is
/// late.
///
/// If a signal or exit() ends the process, the thread stops the motors first: see TerminationGuard.
/// Where the application goes on after the signal, write() fails from then on.
class ThreadedDriver : public Driver
{
public:
  [[nodiscard]] tl::expected<void, DriverError> open(const DriverConfig &config) final;
  int tactors() const final;
  [[nodiscard]] tl::expected<void, DriverError> write(std::span<const double> volts,
                                                      Time now) final;
  /// The destructor of each derived class calls it.
  void close() noexcept final;
  DriverStatus status() const override;
  std::shared_ptr<DeviceAccount> account() const final;

protected:
  using Lock = PriorityLock;

  /// On the thread, with the lock, which it releases while it waits, uses the device or reports.
  /// Calls opened() or refuse() once, and returns soon after quit_ is set, with motors at zero and
  /// the device released.
  virtual void run(Lock &lock) = 0;
  /// Forgets the last play. With the lock, without a thread.
  virtual void reset() = 0;
  /// quit_ was set: ends what run() waits for besides changed_. With the lock, which it may
  /// release; any thread.
  virtual void wake(Lock & /*lock*/)
  {
  }

  /// There are new_levels(): ends what run() waits for besides changed_. With the lock.
  virtual void levels_written()
  {
  }

  /// The thread has the device of this name, which stays when it is lost and returns. With the
  /// lock.
  void use_account(const std::string &device);
  /// Whether levels() are others than at its last call, or may be.
  bool has_new_levels(Time now) const;
  /// The levels for the motors: those of the last write(), 0…1, except those that the limits cut.
  /// They leave now. With the lock, on the thread.
  std::vector<double> levels(Time now);
  /// When levels() change without a write().
  std::optional<Time> levels_end() const;
  /// The motors have no levels any more. With the lock.
  void stand();

  void opened();                         ///< with the lock
  void refuse(const DriverError &error); ///< why open() fails; with the lock
  /// Calls DriverConfig::notify. Releases the lock meanwhile.
  void tell(Lock &lock, DriverEvent::Kind kind, const std::string &text);
  static Time steady_now()
  {
    return std::chrono::steady_clock::now().time_since_epoch();
  }

  mutable PriorityMutex mutex_; ///< guards everything below, and what derived classes say
  PriorityCondition changed_;
  DriverConfig config_;
  bool is_open_ = false;
  bool quit_ = false;
  int tactors_ = 0;
  DriverStatus status_;
  std::vector<double> levels_; ///< as written last
  Time written_at_{ 0 };

  DriverStatus status_now() const; ///< with the lock

private:
  void quit(Lock lock);
  void leave(std::chrono::steady_clock::time_point until);
  void stay();

  bool runs_ = false;     ///< the thread has the device; guarded by the mutex
  bool was_left_ = false; ///< for a signal that did not end the process; guarded by the mutex
  std::optional<DriverError> refusal_;     ///< guarded by the mutex
  bool is_new_ = false;                    ///< levels_ were not taken; guarded by the mutex
  std::shared_ptr<DeviceAccount> account_; ///< of the last device; guarded by the mutex
  std::uint64_t cuts_before_ = 0;          ///< of the account; guarded by the mutex

  // For the thread that opens and closes
  Thread thread_;
  std::unique_ptr<TerminationGuard> guard_; ///< from the beginning of open() to the end of close()
};

} // namespace tactor
