// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/command_queue.h"
#include "tactor/command_trace.h"
#include "tactor/driver.h"
#include "tactor/realtime/realtime_thread.h"
#include "tactor/schedule_statistics.h"
#include "tactor/soft_start.h"
#include "tactor/thread.h"
#include "tactortiming.h"

#include <gst/gst.h>
#include <tl/expected.hpp>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

/// What a scheduler plays on.
struct TactorOutput
{
  std::unique_ptr<tactor::Driver> driver;      ///< open
  std::unique_ptr<tactor::CommandTrace> trace; ///< may be null
};

/// The thread that opens a board and hands commands to its driver when they are due, and the only
/// one that talks to the driver.
///
/// It stores no clock time: clock, base time, latency and ts-offset are read at each turn, so that
/// a pause, a new clock or a new latency needs no case of its own. Every public method but start()
/// may be called from any thread, and all but start() and stop() by the host when it is told
/// something; pause(), flush() and stop() return when all motors are at zero.
class TactorScheduler
{
public:
  /// A command handed over later than this after it was due counts as late: a tenth of the ± 50 ms
  /// within which haptics that come late pass unnoticed (Di Luca & Mahnan 2019).
  static constexpr tactor::Time kLate = std::chrono::milliseconds(5);

  struct Counters
  {
    guint64 issued = 0;
    guint64 late = 0;
    guint64 came_late = 0; ///< handed over after they were due
    guint64 thread_late
        = 0;               ///< issued kLate after they were due and handed over: the thread's fault
    guint64 coalesced = 0; ///< overtaken by a later command for the same tactor
    /// Thrown away by a flush or a stop before they were due, or when their map had expired.
    guint64 dropped = 0;
    guint64 starved = 0;              ///< times when no map came and the motors were silenced
    guint64 ramps = 0;                ///< soft starts
    tactor::ScheduleStatistics error; ///< |issued − due|
    tactor::ScheduleStatistics thread_error; ///< issued − due, or what came late: − handed over
  };

  /// What the scheduler needs to know of its element and what it reports to it. Called on the
  /// scheduler's thread without its locks. All but `scheduled` are required.
  struct Host
  {
    std::function<TactorTiming()> timing;
    /// The board could not be opened, and not because stop() came first.
    std::function<void(const tactor::DriverError &)> open_failed;
    /// The board failed while it played.
    std::function<void(const tactor::DriverError &)> device_failed;
    /// A command was issued `late` after its due time: upstream did not deliver it `lead` ahead of
    /// its frame.
    std::function<void(tactor::Time lead, tactor::Time late)> lead_short;
    /// How the thread is scheduled from now on, and why, in one line. Also called on the thread
    /// that requested it.
    std::function<void(tactor::Scheduling, const std::string &)> scheduled{};
  };

  explicit TactorScheduler(Host host);
  ~TactorScheduler();
  TactorScheduler(const TactorScheduler &) = delete;
  TactorScheduler &operator=(const TactorScheduler &) = delete;

  /// Opens a board on the scheduler's thread, which may take seconds: a stop request ends it early.
  using Open = std::function<tl::expected<TactorOutput, tactor::DriverError>(std::stop_token stop)>;

  /// Begins to open. `full_scale_volts` is what the board makes at most. Paused until play(). With
  /// `realtime` the thread asks to be real-time, which no one waits for. Fails if there is no
  /// thread.
  [[nodiscard]] tl::expected<void, tactor::DriverError> start(Open open, double full_scale_volts,
                                                              bool realtime = false);
  enum class Outcome
  {
    open,        ///< the board can be played on
    failed,      ///< the board could not be opened, or failed
    stopped,     ///< stop() came, or start() did not
    interrupted, ///< there is an interruption that is not among the first ones
  };
  /// Waits for the board. Not to be called by the host. For `interruptions` see interruptions().
  Outcome wait_until_open(std::uint64_t interruptions);
  /// Whether the board is open. Nothing is waited for.
  bool is_open() const;
  /// Motors to zero, driver closed, thread joined. An open() that waits is stopped. Harmless when
  /// not started.
  void stop();

  /// Commands are issued; what the motors were told last is issued again. Unless `is_wanted` says,
  /// asked under the lock, that the play is over: so a pause() of another thread's, whose reason it
  /// knows, counts whichever of the two comes first.
  void play(const std::function<bool()> &is_wanted = nullptr);
  /// Motors to zero; commands are kept.
  void pause();
  /// Motors to zero; commands are forgotten. Returns the running time at which that was.
  tactor::Time flush();
  /// Returns when every command was issued, however long the play is paused meanwhile, or when it
  /// is interrupted or was after `interruptions` of them were over.
  void drain(std::uint64_t interruptions);
  void interrupt(bool interrupted);
  /// How many interruptions are over. To be asked for before the lock is given up that keeps others
  /// from interrupting: one may begin and end before drain() has seen it.
  std::uint64_t interruptions() const;
  /// While muted, motors are at zero and the film's commands are followed silently.
  void set_muted(bool muted);
  /// How long the first vibration after start(), pause(), flush(), mute or a lost board takes to
  /// full scale, from the next one on; not where commands don't wait for the clock.
  void set_ramp_in(tactor::Time length);
  /// While the board is away its driver is told that all motors are at zero: so they are when it
  /// returns, and then start softly. Returns at once, since it is called on the driver's thread.
  void set_board_away(bool away);
  /// While immediate, commands do not wait for the clock (sync=false): push() returns when they
  /// were issued, each as if its time had come, and the trace has its due time as when it was
  /// issued.
  void set_immediate(bool immediate);

  /// New commands, of a map that holds until `expires`: if none follows by then, the motors are
  /// silenced, and what would be issued only then is dropped. `now` is the running time, where
  /// there is a clock.
  void push(std::span<const tactor::Command> commands, tactor::Time expires,
            tactor::Time now = tactor::Time::min());

  /// When the motors were silenced for want of a map, if they were since the last call: whoever
  /// plans must know.
  std::optional<tactor::Time> take_starved();

  /// Clock, base time, latency or ts-offset changed.
  void timing_changed();

  Counters counters() const;
  /// Of the driver; after stop() as it was then.
  tactor::DriverStatus driver_status() const;
  /// Of the thread; after stop() as it was then.
  tactor::Scheduling scheduling() const;
  bool trace_failed() const;
  /// Whether the driver failed for good (open_failed(), device_failed() of the host).
  bool failed() const;

private:
  using Lock = std::unique_lock<std::mutex>;

  // All of these run on the scheduler's thread, but settle() and wake(); all but run() are called
  // with the lock held and give it up while they wait, while the driver is at work and while the
  // host is told something.
  void run(const Open &open, const std::stop_token &stop, bool realtime);
  bool open_output(Lock &lock, const Open &open, const std::stop_token &stop);
  void turn(Lock &lock);
  void wait_until(Lock &lock, const TactorTiming &timing, tactor::Time running);
  bool issue_due(Lock &lock, bool timed);
  void issue(Lock &lock, tactor::Time running, std::span<const tactor::Command> commands,
             bool timed);
  void starve(Lock &lock, tactor::Time running);
  void apply(Lock &lock, tactor::Time running, std::span<const tactor::Command> commands);
  void trace_changes(tactor::Time running, std::span<const tactor::Command> commands,
                     std::span<const double> volts);
  void fail(Lock &lock, tactor::Time running, const tactor::DriverError &error);
  void close_driver(Lock &lock);
  void settle(Lock &lock);
  void wake();

  const Host host_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::condition_variable settled_; ///< met_, live_ or failed_ changed
  tactor::Thread thread_;
  std::stop_source opening_;
  GstClockID waiting_ = nullptr; ///< what the thread sleeps on, owned by it

  std::atomic<tactor::Scheduling> scheduling_{ tactor::Scheduling::normal };
  bool live_ = false; ///< the board is open and the thread attends to requests
  bool quit_ = false;
  bool playing_ = false;
  bool muted_ = false;
  bool immediate_ = false;
  bool interrupted_ = false;
  std::uint64_t interruptions_ = 0; ///< that have begun
  bool failed_ = false;
  bool issuing_ = false; ///< commands were taken off the queue and are on their way to the driver
  // Requests: something other than a due command has to reach the motors, or to be looked at anew.
  // Numbered, so that each caller waits for the turn that saw its own: the one before may still be
  // writing.
  std::uint64_t requested_ = 0;
  std::uint64_t met_ = 0;     ///< the last request that was met
  tactor::Time running_{ 0 }; ///< running time of the last turn on the clock
  std::optional<tactor::Time> expires_;
  std::optional<tactor::Time> refresh_; ///< when the driver is told again what it was told
  std::optional<tactor::Time> starved_; ///< see take_starved()
  bool timed_ = false;                  ///< commands wait for the clock
  bool away_ = false;                   ///< the board was lost and is not back
  tactor::SoftStart soft_start_;
  double ceiling_ = 1; ///< of the soft start, as applied last

  std::unique_ptr<tactor::Driver> driver_;
  tactor::DriverStatus last_status_; ///< when there is no driver any more
  tactor::Time refresh_interval_{ 0 };
  tactor::LineTime line_; ///< to the board
  double full_scale_volts_ = 0;
  std::unique_ptr<tactor::CommandTrace> trace_;
  tactor::CommandQueue queue_;
  std::vector<double> sent_; ///< volts that the driver has, one for each tactor used so far
  Counters counters_;
};
