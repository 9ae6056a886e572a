// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace tactor {

class RealtimeQuestion;

/// How a thread is scheduled, and by whose leave.
enum class Scheduling
{
  normal,       ///< like any other
  direct,       ///< real-time: the process may do so itself (RLIMIT_RTPRIO, CAP_SYS_NICE)
  realtime_kit, ///< real-time by RealtimeKit
  portal,       ///< real-time by the desktop portal, as in a sandbox
  given_back,   ///< was real-time until it used too much CPU time
};

/// "normal", "direct", "rtkit", "portal", "given-back".
std::string_view to_string(Scheduling scheduling);

/// How much CPU time a real-time thread may use: `kShare` of all time, and `kBurst` at once. Not
/// thread-safe.
class CpuBudget
{
public:
  static constexpr double kShare = 0.25;
  /// A quarter of the 200 ms after which the kernel kills a process of RealtimeKit's (its default).
  static constexpr Time kBurst = std::chrono::milliseconds(50);

  /// `now` on any clock, `cpu` used by then.
  CpuBudget(Time now, Time cpu);

  /// Whether there is something left.
  bool allows(Time now, Time cpu);

private:
  Time now_;
  Time cpu_;
  Time left_ = kBurst;
};

/// While it lives, the thread that made it runs before all that is not real-time, if that may be
/// had; if not, it works as without. All but the callback is that thread's. SCHED_RR, not inherited
/// by threads and processes that it begins.
///
/// RealtimeKit and the portal are asked on a thread of their own, which nobody waits for: the
/// thread is real-time some milliseconds later, and an answer that has not come when this is
/// destroyed is given up.
class RealtimeThread
{
public:
  /// The lowest there is. What comes out of a loudspeaker late is heard after five milliseconds;
  /// what a motor does late is not felt for ten times as long.
  static constexpr int kPriority = 1;

  /// What came of it, and how or why, in one line. Called on this thread, by the constructor or
  /// turn(), or on the one that asks; once for each answer, and not after the destructor.
  using Tell = std::function<void(Scheduling, const std::string &)>;

  explicit RealtimeThread(bool wanted, Tell tell = nullptr);
  ~RealtimeThread();
  RealtimeThread(const RealtimeThread &) = delete;
  RealtimeThread &operator=(const RealtimeThread &) = delete;

  /// To be called at each turn of the thread's loop: a thread that uses more than its CpuBudget
  /// gives the priority back for good.
  void turn();

private:
  void set(Scheduling scheduling, const std::string &text);

  const Tell tell_;
  std::atomic<Scheduling> scheduling_{ Scheduling::normal };
  CpuBudget budget_;
  std::unique_ptr<RealtimeQuestion> question_; ///< last: it answers into the others
};

} // namespace tactor
