// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What the kernel says of a thread's scheduling.
#pragma once

#include <sched.h>
#include <sys/types.h>

#include <thread>

/// SCHED_OTHER or SCHED_RR, as a rule; 0 is the calling thread.
inline int
policy_of(pid_t thread)
{
  return sched_getscheduler(thread) & ~SCHED_RESET_ON_FORK;
}

/// Whether this process may make its threads real-time without asking anybody.
inline bool
may_be_realtime()
{
  bool may = false;
  std::thread([&] {
    const sched_param parameters{ .sched_priority = 1 };
    may = sched_setscheduler(0, SCHED_RR, &parameters) == 0;
  }).join();
  return may;
}
