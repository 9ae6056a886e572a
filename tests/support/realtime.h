// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A thread's scheduling according to the kernel.
#pragma once

#include <sched.h>
#include <sys/types.h>

#include <filesystem>
#include <string>
#include <thread>

/// Usually SCHED_OTHER or SCHED_RR. 0 stands for the calling thread.
inline int
policy_of(pid_t thread)
{
  return sched_getscheduler(thread) & ~SCHED_RESET_ON_FORK;
}

/// How many threads of this process are real-time.
inline int
realtime_threads()
{
  int count = 0;
  for (const auto &task : std::filesystem::directory_iterator("/proc/self/task"))
    count += policy_of(std::stoi(task.path().filename())) == SCHED_RR;
  return count;
}

/// Whether this process may make its threads real-time by itself.
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
