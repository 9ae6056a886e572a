// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/realtime/scheduling.h"

#include <functional>
#include <memory>
#include <string>

#include <sys/types.h>

namespace tactor {

/// Requests real-time scheduling of a thread of this process over D-Bus, of RealtimeKit, else of
/// the desktop portal. It has a thread and connections of its own, which end with it.
///
/// Both services require a limit on the CPU time of the process's real-time threads
/// (RLIMIT_RTTIME), after which the kernel kills it. The limit is lowered as required, never
/// raised, and left alone if other threads are real-time already and have none.
class RealtimeRequest
{
public:
  /// Called once with the service that granted it, or Scheduling::normal and the reason. On the
  /// requesting thread; without one, by the constructor.
  using Answer = std::function<void(Scheduling, const std::string &)>;

  RealtimeRequest(pid_t thread, int priority, Answer answer);
  /// Cancels a pending request.
  ~RealtimeRequest();
  RealtimeRequest(const RealtimeRequest &) = delete;
  RealtimeRequest &operator=(const RealtimeRequest &) = delete;

private:
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace tactor
