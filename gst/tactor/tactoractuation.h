// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/command_queue.h"
#include "tactor/command_trace.h"
#include "tactor/driver.h"
#include "tactor/schedule_statistics.h"
#include "tactor/soft_start.h"

#include <glib.h>

#include <memory>
#include <optional>
#include <span>
#include <vector>

/// Decides the levels of the motors: due commands, silence, soft start, refresh, and their trace.
/// It has no clock, thread or lock and writes to no board; the scheduler guards it and carries out
/// its steps.
class TactorActuation
{
public:
  /// A command issued later than this after it was due counts as late: a tenth of the ± 50 ms
  /// within which haptics that come late pass unnoticed (Di Luca & Mahnan 2019).
  static constexpr tactor::Time kLate = std::chrono::milliseconds(5);

  struct Counters
  {
    guint64 issued = 0;
    guint64 late = 0;
    guint64 came_late = 0; ///< pushed after they were due
    /// Issued more than kLate after they were due and pushed: the thread's fault.
    guint64 thread_late = 0;
    guint64 coalesced = 0; ///< replaced by a later command for the same tactor
    /// Dropped by a flush or a stop before they were due, or because their map had expired.
    guint64 dropped = 0;
    guint64 expired = 0;              ///< dropped with a map: no CPU time for stream or thread
    guint64 starved = 0;              ///< times when no map came and the motors were silenced
    guint64 ramps = 0;                ///< soft starts
    tactor::ScheduleStatistics error; ///< |issued − due|
    tactor::ScheduleStatistics thread_error; ///< issued − max(due, pushed)
  };

  /// The state at a step.
  struct Now
  {
    tactor::Time running{ 0 }; ///< running time
    bool timed = false;        ///< commands wait for the clock, and soft starts take time
    bool silent = false;       ///< the motors are to be at zero whatever the levels are
  };

  /// A command that was issued `late` after its due time: it did not come `lead` ahead of its
  /// frame.
  struct ShortLead
  {
    tactor::Time lead{ 0 };
    tactor::Time late{ 0 };
  };

  /// Something to be done at once.
  struct Step
  {
    tactor::Time running{ 0 };
    std::vector<tactor::Command> commands;    ///< that led to it
    std::optional<std::vector<double>> volts; ///< to be written; none: the board has these volts
  };

  /// Forgets the last play. `full_scale_volts` is what the board makes at most.
  void start(double full_scale_volts);
  /// Steps have volts from now on, until failed() or close(). The trace may be null.
  void open(const tactor::Driver &driver, std::unique_ptr<tactor::CommandTrace> trace);
  void close();

  /// New commands of a map that holds until `expires`. `now` is the running time, where there is a
  /// clock. True if next() may be earlier than before.
  [[nodiscard]] bool push(std::span<const tactor::Command> commands, tactor::Time expires,
                          tactor::Time now);
  /// Drops all commands; the next vibration starts softly.
  void clear();
  void set_ramp_in(tactor::Time length);

  /// Running time of the next step; none: there is nothing to do.
  std::optional<tactor::Time> next(tactor::Time running) const;
  /// Commands that wait to be due.
  std::size_t pending() const;
  /// Takes the commands that are due. Timed, these are those up to now, or silence where the last
  /// map has expired; untimed, the earliest ones, each as if its time had come. None if nothing is
  /// due.
  std::optional<Step> take_due(const Now &now);
  /// Whether update() has something to do for a soft start or a refresh.
  bool needs_update(const Now &now) const;
  /// Brings the motors to what holds now.
  Step update(const Now &now);
  /// After a step's volts were written.
  void written(const Step &step);
  /// After writing them failed: the motors are at zero and there is no board any more.
  void failed(tactor::Time running);

  /// How long the board may wait for its next volts; none: for ever.
  std::optional<tactor::Time> refresh_interval() const;
  /// The volts are written again at this running time or after the interval, whichever is first.
  void refresh_by(tactor::Time running);

  /// Running time at which the motors were silenced for want of a map, if they were since the last
  /// call.
  std::optional<tactor::Time> take_starved();
  /// The latest command that was late, if one was since the last call.
  std::optional<ShortLead> take_short_lead();
  Counters counters() const;
  void flush_trace();
  bool trace_failed() const;

private:
  Step starve(const Now &now);
  void count(const Step &step);
  void note(const ShortLead &lead);
  Step with_volts(const Now &now, Step step);
  void trace(tactor::Time running, std::span<const tactor::Command> commands,
             std::span<const double> volts);

  tactor::CommandQueue queue_{ 0 };
  std::optional<tactor::Time> expires_; ///< of the last map
  std::optional<tactor::Time> starved_; ///< see take_starved()
  std::optional<ShortLead> short_lead_; ///< see take_short_lead()

  bool open_ = false;
  double full_scale_volts_ = 0;
  tactor::LineTime line_; ///< to the board
  tactor::Time refresh_interval_{ 0 };
  std::optional<tactor::Time> refresh_; ///< when the volts are written again
  tactor::SoftStart soft_start_;
  double ceiling_ = 1;       ///< of the soft start in the last step
  std::vector<double> sent_; ///< volts that the board has, of each tactor used so far

  std::unique_ptr<tactor::CommandTrace> trace_;
  Counters counters_;
};
