// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <chrono>
#include <functional>

namespace tactor {

/// While one exists, the motors are stopped before a signal, abort() or exit() ends the process.
///
/// Every signal that ends a process by default and is no fault of its code is caught while its
/// action is the default one. Those that the application handles or ignores are left alone; when it
/// drops its handler, the signal is caught within kLook. After the last guard all have their
/// default action again.
///
/// The handler writes a byte to a pipe; a thread calls every `leave` and raises the first signal
/// again with its default action, so that the exit status is right. abort() waits for that on its
/// own thread, whose core it is. That takes kPatience at most, and no other signal ends the process
/// meanwhile but SIGKILL: a closed terminal or timeout(1) sends several within microseconds. Forked
/// children are not affected.
///
/// No signal is caught where the environment has VISUOTACTILE_NO_SIGNALS.
class TerminationGuard
{
public:
  using Leave = std::function<void(std::chrono::steady_clock::time_point until)>;
  struct Calls
  {
    Leave leave;
    std::function<void()> stay;
  };

  static constexpr std::chrono::seconds kPatience{ 2 };
  static constexpr std::chrono::milliseconds kLook{ 50 };

  /// `leave` stops the motors and returns when that is done or at the given time; it may be called
  /// again. `stay` is called afterwards if the process goes on, as the application handles the
  /// signal by then. Both run on another thread. The destructor waits for them.
  explicit TerminationGuard(Leave leave, std::function<void()> stay = nullptr);
  ~TerminationGuard();
  TerminationGuard(const TerminationGuard &) = delete;
  TerminationGuard &operator=(const TerminationGuard &) = delete;

private:
  const Calls calls_;
};

} // namespace tactor
