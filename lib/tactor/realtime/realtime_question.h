// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/realtime/realtime_thread.h"

#include <functional>
#include <memory>
#include <string>

#include <sys/types.h>

namespace tactor {

/// Asks by D-Bus that a thread of this process be real-time: RealtimeKit, else the desktop portal.
/// On a thread and over connections of its own, which end with the question.
///
/// Both ask for a limit on the CPU time of the process's real-time threads (RLIMIT_RTTIME), after
/// which the kernel kills it. It is lowered as far as they want, never raised, and not where other
/// threads are real-time already and have no such limit.
class RealtimeQuestion
{
public:
  /// Called once, on the thread that asks (where none can be had, by the constructor): who did it,
  /// or Scheduling::normal and why nobody did.
  using Answer = std::function<void(Scheduling, const std::string &)>;

  RealtimeQuestion(pid_t thread, int priority, Answer answer);
  /// Gives up at once what is not answered yet.
  ~RealtimeQuestion();
  RealtimeQuestion(const RealtimeQuestion &) = delete;
  RealtimeQuestion &operator=(const RealtimeQuestion &) = delete;

private:
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace tactor
