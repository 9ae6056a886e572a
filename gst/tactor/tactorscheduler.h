// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/command_trace.h"
#include "tactor/driver.h"
#include "tactor/priority_mutex.h"
#include "tactor/realtime/scheduling.h"
#include "tactor/thread.h"
#include "tactoractuation.h"
#include "tactortiming.h"

#include <tl/expected.hpp>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>

/// The driver and trace of a play.
struct TactorOutput
{
  std::unique_ptr<tactor::Driver> driver;      ///< open
  std::unique_ptr<tactor::CommandTrace> trace; ///< may be null
};

/// The thread that opens a board, issues commands when they are due, and alone uses the driver.
///
/// It reads clock, base time, latency and ts-offset anew at each turn, so that a pause, a new clock
/// or a new latency is no special case. All public methods but start() may be called from any
/// thread, and all but start(), stop(), wait_until_open() and drain() from within the host's
/// functions. pause(), flush() and stop() return when all motors are at zero.
class TactorScheduler
{
public:
  using Counters = TactorActuation::Counters;

  /// Functions of the element: times that the scheduler reads and events that it reports. Called on
  /// the scheduler's thread without its locks. All but `scheduled` are required.
  struct Host
  {
    std::function<TactorTiming()> timing;
    /// The board could not be opened. Not called after stop().
    std::function<void(const tactor::DriverError &)> open_failed;
    /// The board failed during play.
    std::function<void(const tactor::DriverError &)> device_failed;
    /// How the thread is scheduled from now on, and the reason in one line. Also called on the
    /// thread that requests it.
    std::function<void(tactor::Scheduling, const std::string &)> scheduled{};
  };

  explicit TactorScheduler(Host host);
  ~TactorScheduler();
  TactorScheduler(const TactorScheduler &) = delete;
  TactorScheduler &operator=(const TactorScheduler &) = delete;

  /// Opens a board. Runs on the scheduler's thread and may take seconds; a stop request cancels it.
  using Open = std::function<tl::expected<TactorOutput, tactor::DriverError>(std::stop_token stop)>;

  /// Starts the thread, which opens the board. Paused until play(). `full_scale_volts` is what the
  /// board makes at most. With `realtime` the thread requests real-time scheduling and does not
  /// wait for it. Fails if the system has no more threads.
  [[nodiscard]] tl::expected<void, tactor::DriverError> start(Open open, double full_scale_volts,
                                                              bool realtime = false);
  enum class Outcome
  {
    open,
    failed,      ///< the board could not be opened, or failed
    stopped,     ///< stop() was called, or start() was not
    interrupted, ///< an interruption has begun since the count
  };
  /// Waits until the board is open. `interruptions` is a count from interruptions().
  Outcome wait_until_open(std::uint64_t interruptions);
  bool is_open() const;
  /// Motors to zero, driver closed, thread joined. Cancels a pending open. Harmless when not
  /// started.
  void stop();

  /// Issues commands, and first the current levels. Does nothing if `is_wanted`, called under the
  /// lock, returns false: a pause() on another thread then wins in either order.
  void play(const std::function<bool()> &is_wanted = nullptr);
  /// Motors to zero; commands are kept.
  void pause();
  /// Motors to zero; commands are dropped. Returns the running time of the flush.
  tactor::Time flush();
  /// Waits until every command was issued, also through a pause. Ends early if an interruption has
  /// begun since the count.
  void drain(std::uint64_t interruptions);
  void interrupt(bool interrupted);
  /// The number of interruptions that are over. Take it before releasing the lock that keeps others
  /// from interrupting: an interruption may begin and end before the wait does.
  std::uint64_t interruptions() const;
  /// While muted, motors are at zero and commands are consumed.
  void set_muted(bool muted);
  /// Time to full scale of the first vibration after start(), pause(), flush(), mute or a lost
  /// board. Holds from the next one on, and not while immediate.
  void set_ramp_in(tactor::Time length);
  /// While the board is away the driver is set to zero, so that the motors start softly when it
  /// returns. Does not wait, as it is called on the driver's thread.
  void set_board_away(bool away);
  /// While immediate, commands do not wait for the clock (sync=false): push() returns when they are
  /// issued, each with its due time as running time.
  void set_immediate(bool immediate);

  /// Adds the commands of a map that holds until `expires`. If no other map has come by then, the
  /// motors are silenced, and commands that come due only then are dropped. `now` is the running
  /// time, where there is a clock.
  void push(std::span<const tactor::Command> commands, tactor::Time expires,
            tactor::Time now = tactor::Time::min());

  /// Running time at which the motors were silenced for want of a map, if they were since the last
  /// call. The planner has to know it.
  std::optional<tactor::Time> take_starved();

  /// As TactorActuation::take_short_lead(). The thread itself posts no messages: it would wait for
  /// locks of the element and the bus.
  std::optional<TactorActuation::ShortLead> take_short_lead();

  /// To be called when the clock, base time, latency or ts-offset has changed.
  void timing_changed();

  Counters counters() const;
  /// The status of the driver; after stop() the last one.
  tactor::DriverStatus driver_status() const;
  /// The present latency of the driver; after stop() the last one.
  tactor::Time transport_latency() const;
  /// The scheduling of the thread; after stop() the last one.
  tactor::Scheduling scheduling() const;
  bool trace_failed() const;
  /// Whether open_failed() or device_failed() was called.
  bool failed() const;

private:
  using Lock = tactor::PriorityLock;

  // On the scheduler's thread, but for settle(), wake() and now(). Those with a lock release it
  // while they wait, use the driver or call the host.
  void run(const Open &open, const std::stop_token &stop, bool realtime);
  bool open_output(Lock &lock, const Open &open, const std::stop_token &stop);
  void turn(Lock &lock);
  void wait_until(Lock &lock, const TactorTiming &timing, tactor::Time running);
  bool issue_due(Lock &lock);
  void carry_out(Lock &lock, const TactorActuation::Step &step);
  void fail(Lock &lock, tactor::Time running, const tactor::DriverError &error);
  void close_driver(Lock &lock);
  void settle(Lock &lock);
  void wake();
  TactorActuation::Now now() const;

  const Host host_;
  mutable tactor::PriorityMutex mutex_; ///< guards all below but scheduling_
  tactor::PriorityCondition wake_;
  tactor::PriorityCondition settled_; ///< met_, live_ or failed_ changed
  tactor::Thread thread_;
  std::stop_source opening_;
  GstClockID waiting_ = nullptr; ///< what the thread sleeps on; owned by it
  std::atomic<tactor::Scheduling> scheduling_{ tactor::Scheduling::normal };

  bool live_ = false; ///< the board is open and the thread serves requests
  bool quit_ = false;
  bool failed_ = false;
  bool playing_ = false;
  bool muted_ = false;
  bool away_ = false; ///< the board was lost and is not back
  bool immediate_ = false;
  bool played_ = false; ///< in the last turn
  ClockRest clock_rest_;
  bool timed_ = false;   ///< commands wait for the clock
  bool issuing_ = false; ///< commands left the queue and are on their way to the driver
  bool interrupted_ = false;
  std::uint64_t interruptions_ = 0; ///< that have begun
  // A request is a change other than a due command that may affect the motors. Each has a number,
  // so that its caller waits for a turn that has seen it.
  std::uint64_t requested_ = 0;
  std::uint64_t met_ = 0;     ///< the last request that was met
  tactor::Time running_{ 0 }; ///< running time of the last turn

  std::unique_ptr<tactor::Driver> driver_;
  tactor::DriverStatus last_status_; ///< of the driver that was closed
  tactor::Time last_latency_{ 0 };   ///< of the driver that was closed
  TactorActuation actuation_;
};
