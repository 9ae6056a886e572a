// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/realtime/realtime_thread.h"

#include "tactor/realtime/realtime_request.h"

#include <sched.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>

namespace tactor {

namespace {

Time
read_clock(clockid_t clock)
{
  timespec time{};
  clock_gettime(clock, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

/// Sets it for the calling thread. Always with SCHED_RESET_ON_FORK: a thread that has it may not
/// drop it on its way back to SCHED_OTHER.
bool
schedule(int policy, int priority)
{
  const sched_param parameters{ .sched_priority = priority };
  return sched_setscheduler(0, policy | SCHED_RESET_ON_FORK, &parameters) == 0;
}

bool
is_realtime(Scheduling scheduling)
{
  return scheduling != Scheduling::normal && scheduling != Scheduling::given_back;
}

} // namespace

CpuBudget::CpuBudget(Time now, Time cpu) : now_(now), cpu_(cpu)
{
}

bool
CpuBudget::allows(Time now, Time cpu)
{
  const auto earned = std::chrono::duration_cast<Time>((now - now_) * kShare);
  left_ = std::min(kBurst, left_ + earned) - (cpu - cpu_);
  now_ = now;
  cpu_ = cpu;
  return left_ >= Time(0);
}

RealtimeThread::RealtimeThread(bool wanted, Tell tell)
    : tell_(std::move(tell)),
      budget_(read_clock(CLOCK_MONOTONIC), read_clock(CLOCK_THREAD_CPUTIME_ID))
{
  if (!wanted) {
    set(Scheduling::normal, "not requested");
  } else if (schedule(SCHED_RR, kPriority)) {
    set(Scheduling::direct, "allowed to this process");
  } else {
    const std::string why = std::string("this process may not itself (") + std::strerror(errno)
                            + "; see RLIMIT_RTPRIO)";
    request_ = std::make_unique<RealtimeRequest>(
        gettid(), kPriority, [this, why](Scheduling scheduling, const std::string &text) {
          set(scheduling, scheduling == Scheduling::normal ? why + "; " + text : text);
        });
  }
}

RealtimeThread::~RealtimeThread()
{
  request_.reset();
  schedule(SCHED_OTHER, 0);
}

void
RealtimeThread::turn()
{
  if (!is_realtime(scheduling_)
      || budget_.allows(read_clock(CLOCK_MONOTONIC), read_clock(CLOCK_THREAD_CPUTIME_ID)))
    return;
  schedule(SCHED_OTHER, 0);
  set(Scheduling::given_back, "it used too much CPU time");
}

void
RealtimeThread::set(Scheduling scheduling, const std::string &text)
{
  scheduling_ = scheduling;
  if (tell_)
    tell_(scheduling, text);
}

} // namespace tactor
