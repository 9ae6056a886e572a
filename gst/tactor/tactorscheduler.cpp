// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactorscheduler.h"

#include <algorithm>
#include <utility>

using tactor::Command;
using tactor::Time;

TactorScheduler::TactorScheduler(Host host) : host_(std::move(host)), queue_(0)
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
  full_scale_volts_ = full_scale_volts;
  queue_ = tactor::CommandQueue(0);
  sent_.clear();
  last_status_ = {};
  counters_ = {};
  expires_.reset();
  refresh_.reset();
  starved_.reset();
  soft_start_.arm();
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
  std::unique_lock lock(mutex_);
  if (is_wanted && !is_wanted())
    return;
  playing_ = true;
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
  counters_.dropped += queue_.clear();
  expires_.reset();
  starved_.reset();
  soft_start_.arm();
  settle(lock);
  return running_;
}

void
TactorScheduler::drain(std::uint64_t interruptions)
{
  std::unique_lock lock(mutex_);
  settled_.wait(lock, [&] {
    return interruptions_ != interruptions || !live_ || failed_
           || (queue_.size() == 0 && !issuing_);
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
  muted_ = muted;
  settle(lock);
}

void
TactorScheduler::set_ramp_in(Time length)
{
  std::lock_guard lock(mutex_);
  soft_start_.set_length(length);
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
TactorScheduler::push(std::span<const Command> commands, Time expires, Time now)
{
  std::vector<Command> known(commands.begin(), commands.end());
  for (Command &command : known)
    command.known = now;
  std::unique_lock lock(mutex_);
  const std::optional<Time> before = queue_.next_due();
  queue_.push(known);
  const bool sleeps_on_nothing = !before && !expires_;
  expires_ = expires;
  // A wait that ends too early looks again and goes on waiting; only one that would end too late is
  // cut short.
  if (sleeps_on_nothing || (queue_.next_due() && (!before || *queue_.next_due() < *before)))
    wake();
  // Nobody paces a stream that does not wait for the clock but who works it off.
  if (immediate_ && playing_)
    settle(lock);
}

void
TactorScheduler::timing_changed()
{
  std::lock_guard lock(mutex_);
  // A request, since the thread may have read the timing already and not be asleep yet.
  requested_++;
  wake();
}

std::optional<Time>
TactorScheduler::take_starved()
{
  std::lock_guard lock(mutex_);
  return std::exchange(starved_, std::nullopt);
}

TactorScheduler::Counters
TactorScheduler::counters() const
{
  std::lock_guard lock(mutex_);
  Counters counters = counters_;
  counters.coalesced = queue_.coalesced();
  return counters;
}

tactor::DriverStatus
TactorScheduler::driver_status() const
{
  std::lock_guard lock(mutex_);
  return driver_ ? driver_->status() : last_status_;
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
  return trace_ && trace_->failed();
}

bool
TactorScheduler::failed() const
{
  std::lock_guard lock(mutex_);
  return failed_;
}

/// Ends whatever the thread waits on; it looks at everything anew.
void
TactorScheduler::wake()
{
  if (waiting_)
    gst_clock_id_unschedule(waiting_);
  wake_.notify_all();
}

/// Returns when what the motors shall do now is what they were told.
void
TactorScheduler::settle(Lock &lock)
{
  if (!live_)
    return;
  const std::uint64_t request = ++requested_;
  wake();
  // The host, when the thread tells it something, must not wait for the thread.
  if (!thread_.is_current())
    settled_.wait(lock, [&] { return met_ >= request || !live_; });
}

/// False if there is nothing to play on. Called with the lock held, which it gives up.
bool
TactorScheduler::open_output(Lock &lock, const Open &open, const std::stop_token &stop)
{
  lock.unlock();
  tl::expected<TactorOutput, tactor::DriverError> opened = open(stop);
  lock.lock();
  if (quit_) { // whoever stopped it waits for no board any more
    lock.unlock();
    opened = tl::unexpected(tactor::DriverError{});
    lock.lock();
  } else if (opened) {
    driver_ = std::move(opened->driver);
    trace_ = std::move(opened->trace);
    refresh_interval_ = driver_->refresh_interval();
    line_ = driver_->line();
    queue_ = tactor::CommandQueue(driver_->tactors());
    live_ = true;
  } else {
    lock.unlock();
    host_.open_failed(opened.error());
    lock.lock();
    failed_ = true; // whoever fails for it does so after the reason was told
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
  counters_.dropped += queue_.clear();
  apply(lock, running_, {});
  close_driver(lock);
  if (trace_)
    trace_->flush();
  trace_.reset();
  live_ = false;
  settled_.notify_all();
}

void
TactorScheduler::turn(Lock &lock)
{
  if (met_ == requested_
      && (!playing_
          || (!queue_.next_due() && !expires_ && !refresh_ && !soft_start_.next_step(running_)))) {
    wake_.wait(lock);
    return;
  }

  // The host takes the element's locks, under which others may be waiting for ours.
  lock.unlock();
  const TactorTiming timing = host_.timing();
  const std::optional<Time> now = timing.now();
  lock.lock();
  const bool timed = timed_ = !immediate_ && now;
  if (timed)
    running_ = *now;
  // After a seek running time begins anew.
  if (refresh_)
    refresh_ = std::min(*refresh_, running_ + refresh_interval_);

  if (met_ != requested_) {
    // Whoever asks for more while the driver is being written to gets another turn.
    const std::uint64_t request = requested_;
    if (playing_)
      issue_due(lock, timed);
    apply(lock, running_, {});
    if (!playing_ && trace_)
      trace_->flush();
    met_ = request;
    settled_.notify_all();
    return;
  }
  if (quit_ || !playing_)
    return;

  if (issue_due(lock, timed)) {
    return;
  } else if ((refresh_ && *refresh_ <= running_)
             || (timed && driver_ && soft_start_.ceiling(running_) != ceiling_)) {
    apply(lock, running_, {});
  } else if (!timed) {
    if (!refresh_)
      wake_.wait(lock);
    else if (wake_.wait_for(lock, refresh_interval_) == std::cv_status::timeout)
      refresh_ = running_;
  } else {
    Time until = Time::max();
    for (const std::optional<Time> &next :
         { queue_.next_due(), expires_, refresh_, soft_start_.next_step(running_) })
      until = std::min(until, next.value_or(Time::max()));
    if (until != Time::max())
      wait_until(lock, timing, until);
  }
}

/// Hands over what is due now. Untimed, that is everything, each command as if its time had come.
/// False if there was nothing.
bool
TactorScheduler::issue_due(Lock &lock, bool timed)
{
  if (!timed)
    expires_.reset();
  // What was shown so long ago is not made up for: a film that is behind would shake the chair.
  if (expires_ && *expires_ <= running_) {
    starve(lock, running_);
    return true;
  }
  bool any = false;
  for (std::optional<Time> next = queue_.next_due();
       next && (timed ? *next <= running_ : queue_.size() > 0); next = queue_.next_due()) {
    if (!timed)
      running_ = *next;
    issuing_ = true;
    issue(lock, running_, queue_.take_due(running_), timed);
    issuing_ = false;
    any = true;
  }
  if (any)
    settled_.notify_all();
  return any;
}

void
TactorScheduler::wait_until(Lock &lock, const TactorTiming &timing, Time running)
{
  const GstClockTimeDiff target = timing.clock_time(running);
  if (target <= 0)
    return;
  const GstClockID id
      = gst_clock_new_single_shot_id(timing.clock(), static_cast<GstClockTime>(target));
  waiting_ = id;
  lock.unlock();
  gst_clock_id_wait(id, nullptr);
  lock.lock();
  waiting_ = nullptr;
  gst_clock_id_unref(id);
}

void
TactorScheduler::issue(Lock &lock, Time running, std::span<const Command> commands, bool timed)
{
  Time latest{ 0 };
  Time lead{ 0 };
  for (const Command &command : commands) {
    counters_.issued++;
    if (!timed)
      continue;
    const Time late = running - command.due();
    counters_.error.add(late);
    if (late > kLate)
      counters_.late++;
    counters_.came_late += command.known > command.due();
    const Time waited = running - std::max(command.due(), command.known);
    counters_.thread_error.add(waited);
    counters_.thread_late += waited > kLate;
    if (late > latest) {
      latest = late;
      lead = command.lead;
    }
  }
  apply(lock, running, commands);
  if (latest > kLate) {
    lock.unlock();
    host_.lead_short(lead, latest);
    lock.lock();
  }
}

void
TactorScheduler::starve(Lock &lock, Time running)
{
  const std::vector<Command> stale = queue_.take_due(running);
  std::vector<Command> zeros;
  const std::span<const double> levels = queue_.levels();
  for (std::size_t i = 0; i < levels.size(); i++)
    if (levels[i] > 0)
      zeros.push_back(
          { .effect = *expires_, .lead = Time(0), .tactor = static_cast<int>(i), .volts = 0 });
  expires_.reset();
  if (zeros.empty() && stale.empty())
    return;
  counters_.dropped += stale.size();
  counters_.starved += std::ranges::any_of(sent_, [](double volts) { return volts != 0; });
  starved_ = running;
  queue_.push(zeros);
  apply(lock, running, queue_.take_due(running));
  settled_.notify_all();
  if (stale.empty())
    return;
  lock.unlock();
  host_.lead_short(stale.front().lead, running - stale.front().due());
  lock.lock();
}

/// The tactors that are not at zero.
static std::vector<std::size_t>
vibrating(std::span<const double> levels)
{
  std::vector<std::size_t> tactors;
  for (std::size_t i = 0; i < levels.size(); i++)
    if (levels[i] != 0)
      tactors.push_back(i);
  return tactors;
}

/// Makes the driver's volts what they have to be now. `commands` are those that led here, for the
/// trace; any other change (pause, resume, mute, flush, a lost board) is traced as due and in
/// effect when it happened.
void
TactorScheduler::apply(Lock &lock, Time running, std::span<const Command> commands)
{
  if (!driver_)
    return;

  const std::span<const double> levels = queue_.levels();
  // All that the board has been told of, and all that it should be told.
  const auto last
      = std::find_if(levels.rbegin(), levels.rend(), [](double volts) { return volts != 0; });
  std::size_t used = std::max(sent_.size(), static_cast<std::size_t>(levels.rend() - last));
  for (const Command &command : commands)
    used = std::max(used, static_cast<std::size_t>(command.tactor) + 1);
  used = std::min(used, levels.size());

  const bool silent = !playing_ || muted_ || away_;
  sent_.resize(used, 0.0);
  std::vector<double> volts(used, 0.0);
  if (silent)
    soft_start_.arm();
  else if (timed_ && last != levels.rend())
    counters_.ramps += soft_start_.vibrate(running, line_.of(vibrating(levels)));
  ceiling_ = soft_start_.ceiling(running);
  const double ceiling = full_scale_volts_ * (timed_ ? ceiling_ : 1.0);
  if (!silent)
    std::transform(levels.begin(), levels.begin() + static_cast<std::ptrdiff_t>(used),
                   volts.begin(), [=](double level) { return std::min(level, ceiling); });
  if (volts == sent_ && !(refresh_ && *refresh_ <= running))
    return;

  lock.unlock();
  const tl::expected<void, tactor::DriverError> written = driver_->write(volts, running);
  lock.lock();

  if (!written) {
    fail(lock, running, written.error());
    return;
  }
  trace_changes(running, commands, volts);
  sent_ = std::move(volts);
  refresh_.reset();
  if (refresh_interval_ > Time(0) && std::ranges::any_of(sent_, [](double v) { return v != 0; }))
    refresh_ = running + refresh_interval_;
}

void
TactorScheduler::trace_changes(Time running, std::span<const Command> commands,
                               std::span<const double> volts)
{
  if (!trace_)
    return;
  for (std::size_t i = 0; i < volts.size(); i++) {
    if (volts[i] == sent_[i])
      continue;
    const int index = static_cast<int>(i);
    const auto command = std::ranges::find(commands, index, &Command::tactor);
    Command sent{ .effect = running, .lead = Time(0), .tactor = index, .volts = volts[i] };
    if (command != commands.end())
      sent = *command;
    sent.volts = volts[i];
    trace_->write({ .command = sent, .issued = running });
  }
}

void
TactorScheduler::fail(Lock &lock, Time running, const tactor::DriverError &error)
{
  trace_changes(running, {}, std::vector<double>(sent_.size(), 0.0)); // no motor runs on
  sent_.clear();
  refresh_.reset();
  soft_start_.arm();
  failed_ = true;
  close_driver(lock);
  lock.unlock();
  host_.device_failed(error);
  lock.lock();
}

void
TactorScheduler::close_driver(Lock &lock)
{
  if (!driver_)
    return;
  std::unique_ptr<tactor::Driver> driver = std::move(driver_);
  last_status_ = driver->status();
  lock.unlock();
  driver->close();
  const tactor::DriverStatus status = driver->status();
  driver.reset();
  lock.lock();
  last_status_ = status;
}
