// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactor/realtime/scheduling.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <string>

namespace tactor {

class RealtimeRequest;

/// A token bucket of CPU time for a real-time thread: kShare of all time, at most kBurst at once.
/// Not thread-safe.
class CpuBudget
{
public:
  static constexpr double kShare = 0.25;
  /// A quarter of RealtimeKit's default limit of 200 ms, after which the kernel kills the process.
  static constexpr Time kBurst = std::chrono::milliseconds(50);

  /// `now` is of any clock, `cpu` the CPU time used by then.
  CpuBudget(Time now, Time cpu);

  bool allows(Time now, Time cpu);

private:
  Time now_;
  Time cpu_;
  Time left_ = kBurst;
};

/// While it lives, the thread that made it is real-time (SCHED_RR), if that is granted; otherwise
/// it runs as before. Threads and processes that it starts do not inherit it. That thread's only,
/// but for the callback.
///
/// RealtimeKit and the portal are called on another thread. The thread becomes real-time some
/// milliseconds later, and a request that is pending at destruction is canceled.
class RealtimeThread
{
public:
  /// The lowest: audio threads go first. People notice a delay of sound from 5 ms on, one of a
  /// motor from 50 ms on.
  static constexpr int kPriority = 1;

  /// Reports each change of scheduling, with the reason in one line. Called by the constructor or
  /// turn(), or on the requesting thread; not after the destructor.
  using Tell = std::function<void(Scheduling, const std::string &)>;

  explicit RealtimeThread(bool wanted, Tell tell = nullptr);
  ~RealtimeThread();
  RealtimeThread(const RealtimeThread &) = delete;
  RealtimeThread &operator=(const RealtimeThread &) = delete;

  /// To be called at each turn of the thread's loop. A thread that exceeds its CpuBudget loses its
  /// priority for good.
  void turn();

private:
  void set(Scheduling scheduling, const std::string &text);

  const Tell tell_;
  std::atomic<Scheduling> scheduling_{ Scheduling::normal };
  CpuBudget budget_;
  std::unique_ptr<RealtimeRequest> request_; ///< last: its callback uses the others
};

} // namespace tactor
