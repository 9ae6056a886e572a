// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <chrono>
#include <functional>

namespace tactor {

/// While one exists, what would end the process at once, its motors on, first has them stopped:
/// SIGTERM, SIGINT and SIGHUP with the default action, and exit().
///
/// Only signals that have their default action when the first one of these is made are caught, and
/// they have it back when the last one is gone: what the application handles or ignores, before or
/// later, is the application's. The handler writes a byte to a pipe; a thread calls every `leave`,
/// then raises the signal again with its default action, so that whoever waits for the process sees
/// what it died of. That takes kPatience at most; a second signal of the kind ends the process at
/// once. Children that were forked are not concerned.
///
/// No signal is caught where the environment has VISUOTACTILE_NO_SIGNALS.
class TerminationGuard
{
public:
  using Leave = std::function<void(std::chrono::steady_clock::time_point until)>;

  static constexpr std::chrono::seconds kPatience{ 1 };

  /// `leave` begins to leave, and returns when that is done or the time has come; it may be called
  /// again. It is called on a thread of its own, and not any more after the destructor, which waits
  /// for it.
  explicit TerminationGuard(Leave leave);
  ~TerminationGuard();
  TerminationGuard(const TerminationGuard &) = delete;
  TerminationGuard &operator=(const TerminationGuard &) = delete;

private:
  Leave leave_;
};

} // namespace tactor
