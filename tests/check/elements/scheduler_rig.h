// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactorsink's scheduler with a fake host and a fake board on a GstTestClock: all times are exact.
#pragma once

#include "gst/tactor/tactorscheduler.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/temporary_file.h"
#include "trace.h"
#include <gst/check/gstcheck.h>
#include <gst/check/gsttestclock.h>

using tactor::Command;
using tactor::DriverError;
using tactor::Time;
using Volts = std::vector<double>;
using Kind = DriverError::Kind;
using std::chrono::milliseconds;

constexpr Time kForever = std::chrono::hours(1);

inline bool
silent(const Volts &volts)
{
  return std::ranges::all_of(volts, [](double v) { return v == 0; });
}

/// A write to the board.
struct Write
{
  Time now;
  Volts volts;
  bool operator==(const Write &) const = default;
};

/// A fake host with the element's clock. `after_timing` runs once the scheduler has read the timing
/// and before it uses it.
class Host
{
public:
  TactorScheduler::Host calls()
  {
    return { .timing = [this] { return timing(); },
             .open_failed =
                 [this](const DriverError &error) {
                   std::lock_guard lock(mutex_);
                   refusals_.push_back(error.text);
                 },
             .device_failed =
                 [this](const DriverError &) {
                   failed++;
                   if (on_failed)
                     on_failed();
                 } };
  }

  void set(GstClock *clock, Time offset, std::function<void()> after_timing = nullptr)
  {
    std::lock_guard lock(mutex_);
    clock_ = clock;
    offset_ = offset.count();
    after_timing_ = std::move(after_timing);
  }
  std::vector<std::string> refusals()
  {
    std::lock_guard lock(mutex_);
    return refusals_;
  }

  std::atomic<int> failed{ 0 };
  std::function<void()> on_failed;

private:
  TactorTiming timing()
  {
    std::unique_lock lock(mutex_);
    TactorTiming timing(clock_ ? GST_CLOCK(gst_object_ref(clock_)) : nullptr, offset_);
    const std::function<void()> after = std::exchange(after_timing_, nullptr);
    lock.unlock();
    if (after)
      after();
    return timing;
  }

  std::mutex mutex_;
  GstClock *clock_ = nullptr; ///< the rig's
  GstClockTimeDiff offset_ = 0;
  std::function<void()> after_timing_;
  std::vector<std::string> refusals_;
};

/// The board, which outlives its driver: the writes it got, its motors, and faults to simulate.
struct Board
{
  std::mutex mutex;
  std::condition_variable changed;
  int tactors = 4;
  bool open = false;
  Volts volts; ///< at the motors now
  std::vector<Write> writes;
  Time refresh_interval{ 0 }; ///< set before start()
  tactor::LineTime line{};    ///< likewise
  std::optional<Kind> error;  ///< of the next write
  bool hold = false;          ///< writes block…
  int passes = 0;             ///< …except this many
  bool held = false;          ///< a write is blocked
  bool destroyed = false;
  std::string misuse;

  template <typename Value> void set(Value Board::*member, Value value)
  {
    std::lock_guard lock(mutex);
    this->*member = std::move(value);
    changed.notify_all();
  }
  template <typename Value> Value get(Value Board::*member)
  {
    std::lock_guard lock(mutex);
    return this->*member;
  }
  bool is_silent()
  {
    return silent(get(&Board::volts));
  }
  template <typename Condition> void wait_until(Condition condition)
  {
    std::unique_lock lock(mutex);
    changed.wait(lock, condition);
  }
  void wait_until_held()
  {
    wait_until([this] { return held && passes == 0; });
  }
};

class FakeDriver final : public tactor::Driver
{
public:
  explicit FakeDriver(Board &board) : board_(board)
  {
  }
  ~FakeDriver() override
  {
    close();
    board_.set(&Board::destroyed, true);
  }
  tl::expected<void, DriverError> open(const tactor::DriverConfig &) override
  {
    std::lock_guard lock(board_.mutex);
    board_.open = true;
    board_.volts.clear();
    return {};
  }
  int tactors() const override
  {
    std::lock_guard lock(board_.mutex);
    return board_.open ? board_.tactors : 0;
  }
  double resolution() const override
  {
    return 0;
  }
  Time transport_latency() const override
  {
    return Time(0);
  }
  tactor::LineTime line() const override
  {
    return board_.get(&Board::line);
  }
  Time refresh_interval() const override
  {
    return board_.get(&Board::refresh_interval);
  }
  tactor::DriverStatus status() const override
  {
    std::lock_guard lock(board_.mutex);
    tactor::DriverStatus status;
    status.is_there = board_.open;
    status.bytes = board_.writes.size();
    return status;
  }
  tl::expected<void, DriverError> write(std::span<const double> volts, Time now) override
  {
    std::unique_lock lock(board_.mutex);
    if (!board_.open)
      board_.misuse += "write without open; ";
    if (volts.empty() || volts.size() > static_cast<std::size_t>(board_.tactors))
      board_.misuse += "write of " + std::to_string(volts.size()) + " values; ";
    board_.held = board_.hold;
    board_.changed.notify_all();
    board_.changed.wait(lock, [this] { return !board_.hold || board_.passes > 0; });
    board_.passes -= board_.passes > 0;
    board_.held = false;
    if (const std::optional<Kind> error = std::exchange(board_.error, std::nullopt)) {
      board_.volts.clear(); // no power, no vibration
      return tl::unexpected(DriverError{ *error, "unplugged" });
    }
    board_.volts.assign(volts.begin(), volts.end());
    board_.writes.push_back({ now, board_.volts });
    board_.changed.notify_all();
    return {};
  }
  void close() noexcept override
  {
    std::lock_guard lock(board_.mutex);
    board_.open = false;
    board_.volts.clear();
  }

private:
  Board &board_;
};

inline Command
command(int effect_ms, int tactor, double volts, int lead_ms = 0)
{
  return { .effect = milliseconds(effect_ms),
           .lead = milliseconds(lead_ms),
           .tactor = tactor,
           .volts = volts };
}

/// A scheduler in play. Its clock starts at 5 s, which is running time 0.
class SchedulerRig
{
public:
  explicit SchedulerRig(bool play = true)
  {
    clock = GST_TEST_CLOCK(gst_test_clock_new_with_start_time(GST_SECOND * 5));
    host.set(GST_CLOCK(clock), offset);
    scheduler = std::make_unique<TactorScheduler>(host.calls());
    start();
    if (play)
      scheduler->play();
  }
  ~SchedulerRig()
  {
    scheduler.reset();
    fail_unless(board.misuse.empty(), "%s", board.misuse.c_str());
    fail_unless(board.is_silent());
    fail_unless(board.destroyed);
    // The trace must leave all motors at zero, too.
    assert_silent_at_end(unwrap(tactor::read_command_trace(trace_file.path)));
    gst_object_unref(clock);
  }

  void start()
  {
    const tactor::DriverConfig config;
    unwrap(scheduler->start(
        [this, config](std::stop_token) -> tl::expected<TactorOutput, tactor::DriverError> {
          TactorOutput output;
          output.driver = std::make_unique<FakeDriver>(board);
          unwrap(output.driver->open(config));
          output.trace = std::make_unique<tactor::CommandTrace>(
              unwrap(tactor::CommandTrace::create(trace_file.path)));
          return output;
        },
        config.full_scale_volts));
    fail_unless(scheduler->wait_until_open(scheduler->interruptions())
                == TactorScheduler::Outcome::open);
  }
  void push(const std::vector<Command> &commands, Time expires = kForever)
  {
    scheduler->push(commands, expires);
  }
  Time running()
  {
    return Time(static_cast<gint64>(gst_clock_get_time(GST_CLOCK(clock)))) - offset;
  }
  /// Waits until the scheduler sleeps and returns the running time that it waits for.
  Time asleep(GstTestClock *on = nullptr)
  {
    GstClockID id = nullptr;
    gst_test_clock_wait_for_next_pending_id(on ? on : clock, &id);
    const Time time(static_cast<gint64>(gst_clock_id_get_time(id)));
    gst_clock_id_unref(id);
    return time - offset;
  }
  /// Moves the clock in one step and ends the sleep that is over by then.
  void jump_to(Time time)
  {
    const Time until = asleep();
    gst_test_clock_set_time(clock, static_cast<GstClockTime>((time + offset).count()));
    if (until <= time)
      gst_clock_id_unref(gst_test_clock_process_next_clock_id(clock));
  }
  /// Lets time pass, waiting for the scheduler at each of its wake-ups. It must have something to
  /// wait for afterwards.
  void run_to(Time time)
  {
    for (Time next = asleep(); next <= time; next = asleep())
      jump_to(std::max(next, running()));
    jump_to(time);
  }
  void run_to(int ms)
  {
    run_to(milliseconds(ms));
  }
  std::vector<Write> writes()
  {
    return board.get(&Board::writes);
  }

  Board board;
  Host host;
  GstTestClock *clock;
  Time offset = std::chrono::seconds(5);
  TemporaryFile trace_file;
  std::unique_ptr<TactorScheduler> scheduler; ///< destroyed first
};
