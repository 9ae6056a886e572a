// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactorscheduler.h"

#include "tactor/realtime/realtime_thread.h"
#include "tactor/unlocked.h"

#include <utility>

using tactor::Time;

TactorScheduler::TactorScheduler(Host host) : host_(std::move(host))
{
}

TactorScheduler::~TactorScheduler()
{
  stop();
}

tl::expected<void, tactor::DriverError>
TactorScheduler::start(Open open, double full_scale_volts, bool realtime)
{
  stop();
  std::lock_guard lock(mutex_);
  actuation_.start(full_scale_volts);
  last_status_ = {};
  last_latency_ = Time(0);
  quit_ = playing_ = failed_ = away_ = false;
  met_ = requested_;
  running_ = Time(0);
  opening_ = std::stop_source();
  return tactor::Thread::start([this, open = std::move(open), stop = opening_.get_token(),
                                realtime] { run(open, stop, realtime); })
      .map([this](tactor::Thread &&thread) { thread_ = std::move(thread); });
}

TactorScheduler::Outcome
TactorScheduler::wait_until_open(std::uint64_t interruptions)
{
  std::unique_lock lock(mutex_);
  settled_.wait(lock, [&] {
    return interruptions_ != interruptions || live_ || failed_ || quit_ || !thread_;
  });
  if (failed_)
    return Outcome::failed;
  if (live_)
    return Outcome::open;
  return quit_ || !thread_ ? Outcome::stopped : Outcome::interrupted;
}

bool
TactorScheduler::is_open() const
{
  const std::lock_guard lock(mutex_);
  return live_;
}

void
TactorScheduler::stop()
{
  tactor::Thread thread;
  std::stop_source opening;
  {
    std::unique_lock lock(mutex_);
    playing_ = false;
    settle(lock);
    quit_ = true;
    wake();
    settled_.notify_all();
    settled_.wait(lock, [this] { return !live_; });
    opening = opening_;
    thread = std::move(thread_);
  }
  opening.request_stop();
  thread.join();
}

void
TactorScheduler::play(const std::function<bool()> &is_wanted)
{
  const TactorTiming timing
      = host_.timing(); // by the element's locks, whose holders may wait for ours
  std::unique_lock lock(mutex_);
  if (is_wanted && !is_wanted())
    return;
  playing_ = true;
  clock_rest_.begin(timing);
  settle(lock);
}

void
TactorScheduler::pause()
{
  std::unique_lock lock(mutex_);
  playing_ = false;
  settle(lock);
}

Time
TactorScheduler::flush()
{
  std::unique_lock lock(mutex_);
  actuation_.clear();
  settle(lock);
  return running_;
}

void
TactorScheduler::drain(std::uint64_t interruptions)
{
  std::unique_lock lock(mutex_);
  settled_.wait(lock, [&] {
    return interruptions_ != interruptions || !live_ || failed_
           || (actuation_.pending() == 0 && !issuing_);
  });
}

void
TactorScheduler::interrupt(bool interrupted)
{
  std::lock_guard lock(mutex_);
  interruptions_ += interrupted;
  interrupted_ = interrupted;
  settled_.notify_all();
}

std::uint64_t
TactorScheduler::interruptions() const
{
  std::lock_guard lock(mutex_);
  return interruptions_ - (interrupted_ ? 1 : 0);
}

void
TactorScheduler::set_muted(bool muted)
{
  std::unique_lock lock(mutex_);
  if (std::exchange(muted_, muted) != muted)
    settle(lock);
}

void
TactorScheduler::set_ramp_in(Time length)
{
  std::lock_guard lock(mutex_);
  actuation_.set_ramp_in(length);
  wake();
}

void
TactorScheduler::set_board_away(bool away)
{
  std::lock_guard lock(mutex_);
  away_ = away;
  requested_++;
  wake();
}

void
TactorScheduler::set_immediate(bool immediate)
{
  std::lock_guard lock(mutex_);
  immediate_ = immediate;
  wake();
}

void
TactorScheduler::push(std::span<const tactor::Command> commands, Time expires, Time now)
{
  std::unique_lock lock(mutex_);
  // Only a sleep that would end too late is cut short.
  if (actuation_.push(commands, expires, now))
    wake();
  // Backpressure: no clock paces such a stream.
  if (immediate_ && playing_)
    settle(lock);
}

void
TactorScheduler::timing_changed()
{
  std::lock_guard lock(mutex_);
  // A request: the thread may have read the old timing and not be asleep yet.
  requested_++;
  wake();
}

std::optional<Time>
TactorScheduler::take_starved()
{
  std::lock_guard lock(mutex_);
  return actuation_.take_starved();
}

std::optional<TactorActuation::ShortLead>
TactorScheduler::take_short_lead()
{
  std::lock_guard lock(mutex_);
  return actuation_.take_short_lead();
}

TactorScheduler::Counters
TactorScheduler::counters() const
{
  std::lock_guard lock(mutex_);
  return actuation_.counters();
}

tactor::DriverStatus
TactorScheduler::driver_status() const
{
  std::lock_guard lock(mutex_);
  return driver_ ? driver_->status() : last_status_;
}

Time
TactorScheduler::transport_latency() const
{
  std::lock_guard lock(mutex_);
  return driver_ ? driver_->transport_latency() : last_latency_;
}

tactor::Scheduling
TactorScheduler::scheduling() const
{
  return scheduling_;
}

bool
TactorScheduler::trace_failed() const
{
  std::lock_guard lock(mutex_);
  return actuation_.trace_failed();
}

bool
TactorScheduler::failed() const
{
  std::lock_guard lock(mutex_);
  return failed_;
}

/// Ends any wait of the thread's, which starts another turn.
void
TactorScheduler::wake()
{
  if (waiting_)
    gst_clock_id_unschedule(waiting_);
  wake_.notify_all();
}

/// Makes a request and waits until it is met.
void
TactorScheduler::settle(Lock &lock)
{
  if (!live_)
    return;
  const std::uint64_t request = ++requested_;
  wake();
  // The host, when called on the thread, must not wait for it.
  if (!thread_.is_current())
    settled_.wait(lock, [&] { return met_ >= request || !live_; });
}

/// False if there is no board to play on.
bool
TactorScheduler::open_output(Lock &lock, const Open &open, const std::stop_token &stop)
{
  lock.unlock();
  tl::expected<TactorOutput, tactor::DriverError> opened = open(stop);
  lock.lock();
  if (quit_) {
    const tactor::Unlocked unlocked(lock); // closing takes time
    opened = tl::unexpected(tactor::DriverError{});
  } else if (opened) {
    driver_ = std::move(opened->driver);
    actuation_.open(*driver_, std::move(opened->trace));
    live_ = true;
  } else {
    lock.unlock();
    host_.open_failed(opened.error());
    lock.lock();
    failed_ = true; // after the error message
  }
  settled_.notify_all();
  return opened.has_value();
}

void
TactorScheduler::run(const Open &open, const std::stop_token &stop, bool wants_realtime)
{
  {
    std::unique_lock lock(mutex_);
    if (!open_output(lock, open, stop))
      return;
  }
  tactor::RealtimeThread realtime(wants_realtime,
                                  [this](tactor::Scheduling scheduling, const std::string &text) {
                                    scheduling_ = scheduling;
                                    if (host_.scheduled)
                                      host_.scheduled(scheduling, text);
                                  });
  std::unique_lock lock(mutex_);
  while (!quit_) {
    turn(lock);
    lock.unlock();
    realtime.turn();
    lock.lock();
  }
  playing_ = false;
  actuation_.clear();
  carry_out(lock, actuation_.update(now()));
  close_driver(lock);
  actuation_.close();
  live_ = false;
  settled_.notify_all();
}

void
TactorScheduler::turn(Lock &lock)
{
  if (met_ == requested_ && (!playing_ || !actuation_.next(running_))) {
    wake_.wait(lock);
    return;
  }
  const bool clock_rests = playing_ && ClockRest::Clock::now() < clock_rest_.end();
  if (clock_rests && met_ == requested_) {
    wake_.wait_until(lock, clock_rest_.end());
    return;
  }

  const Time running_before = running_;
  const bool stands = !playing_ && !played_;
  // The host takes the element's locks, whose holders may wait for ours.
  lock.unlock();
  const TactorTiming timing = host_.timing();
  // Running time stands still in a pause, and the sound may have gone on already without this
  // thread's knowing.
  const bool rests = clock_rests || (stands && timing.is_of_sound());
  const std::optional<Time> running = rests ? std::optional(running_before) : timing.now();
  lock.lock();
  played_ = playing_;
  timed_ = !immediate_ && running;
  if (timed_)
    running_ = *running;
  const std::optional<Time> refresh_interval = actuation_.refresh_interval();
  if (refresh_interval)
    actuation_.refresh_by(running_ + *refresh_interval); // a seek may have set running time back

  if (met_ != requested_) {
    // A request made during the write gets a turn of its own.
    const std::uint64_t request = requested_;
    if (playing_)
      issue_due(lock);
    carry_out(lock, actuation_.update(now()));
    if (!playing_)
      actuation_.flush_trace();
    met_ = request;
    settled_.notify_all();
    return;
  }
  if (quit_ || !playing_)
    return;

  if (issue_due(lock))
    return;
  if (actuation_.needs_update(now())) {
    carry_out(lock, actuation_.update(now()));
  } else if (!timed_) {
    if (!refresh_interval)
      wake_.wait(lock);
    else if (wake_.wait_for(lock, *refresh_interval) == std::cv_status::timeout)
      actuation_.refresh_by(running_);
  } else if (const std::optional<Time> next = actuation_.next(running_)) {
    wait_until(lock, timing, *next);
  }
}

/// False if nothing was due.
bool
TactorScheduler::issue_due(Lock &lock)
{
  bool any = false;
  while (const std::optional<TactorActuation::Step> step = actuation_.take_due(now())) {
    running_ = step->running;
    issuing_ = true;
    carry_out(lock, *step);
    issuing_ = false;
    any = true;
  }
  if (any)
    settled_.notify_all();
  return any;
}

void
TactorScheduler::carry_out(Lock &lock, const TactorActuation::Step &step)
{
  if (step.volts) {
    lock.unlock();
    const tl::expected<void, tactor::DriverError> written
        = driver_->write(*step.volts, step.running);
    lock.lock();
    if (written)
      actuation_.written(step);
    else
      fail(lock, step.running, written.error());
  }
}

TactorActuation::Now
TactorScheduler::now() const
{
  return { .running = running_, .timed = timed_, .silent = !playing_ || muted_ || away_ };
}

void
TactorScheduler::wait_until(Lock &lock, const TactorTiming &timing, Time running)
{
  const GstClockID id = waiting_ = timing.new_wait(running);
  if (!id)
    return;
  lock.unlock();
  gst_clock_id_wait(id, nullptr);
  lock.lock();
  waiting_ = nullptr;
  gst_clock_id_unref(id);
}

void
TactorScheduler::fail(Lock &lock, Time running, const tactor::DriverError &error)
{
  actuation_.failed(running);
  failed_ = true;
  close_driver(lock);
  const tactor::Unlocked unlocked(lock);
  host_.device_failed(error);
}

void
TactorScheduler::close_driver(Lock &lock)
{
  if (!driver_)
    return;
  std::unique_ptr<tactor::Driver> driver = std::move(driver_);
  last_status_ = driver->status();
  last_latency_ = driver->transport_latency();
  lock.unlock();
  driver->close();
  const tactor::DriverStatus status = driver->status();
  driver.reset();
  lock.lock();
  last_status_ = status;
}
