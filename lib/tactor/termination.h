// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <chrono>
#include <functional>

namespace tactor {

/// While one exists, the motors are stopped before SIGTERM, SIGINT, SIGHUP or exit() ends the
/// process.
///
/// Signals are caught only if they have their default action when the first guard is made, which
/// they get back after the last one. Those that the application handles or ignores are left alone.
/// The handler writes a byte to a pipe; a thread calls every `leave` and raises the signal again
/// with its default action, so that the exit status is right. That takes kPatience at most. A
/// second signal of the same kind ends the process at once. Forked children are not affected.
///
/// No signal is caught where the environment has VISUOTACTILE_NO_SIGNALS.
class TerminationGuard
{
public:
  using Leave = std::function<void(std::chrono::steady_clock::time_point until)>;

  static constexpr std::chrono::seconds kPatience{ 1 };

  /// `leave` stops the motors and returns when that is done or at the given time; it may be called
  /// again. It runs on another thread. The destructor waits for it.
  explicit TerminationGuard(Leave leave);
  ~TerminationGuard();
  TerminationGuard(const TerminationGuard &) = delete;
  TerminationGuard &operator=(const TerminationGuard &) = delete;

private:
  Leave leave_;
};

} // namespace tactor
