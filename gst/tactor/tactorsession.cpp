// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactorsession.h"

#include "../latency.h"
#include "tactormessages.h"

#include <algorithm>
#include <memory>
#include <utility>

using tactor::Time;

GST_DEBUG_CATEGORY_EXTERN(tactor_sink_debug);
#define GST_CAT_DEFAULT tactor_sink_debug

namespace {

/// Data is requested this much before the earliest command can be due, for planning and a wake-up.
constexpr Time kWakeMargin = std::chrono::milliseconds(10);

/// At most one message about short leads in this time.
constexpr Time kLeadShortInterval = std::chrono::seconds(5);

/// The render-delay for the longest latency on the way to a motor, and for a user's delay below 0.
GstClockTime
lead_of(Time max_lead, Time latency, Time delay)
{
  const Time early = std::max(-delay, Time(0));
  return static_cast<GstClockTime>((max_lead + latency + early + kWakeMargin).count());
}

} // namespace

TactorSession::TactorSession(GstBaseSink *sink)
    : sink_(sink), element_(GST_ELEMENT(sink)), grid_(GST_BASE_SINK_PAD(sink)),
      scheduler_({
          .timing = [this] { return glance_at_timing(); },
          .open_failed
          = [this](const tactor::DriverError &error) { tactor_post_open_error(element_, error); },
          .device_failed =
              [this](const tactor::DriverError &error) {
                GST_ELEMENT_ERROR(element_, RESOURCE, WRITE, ("%s", error.text.c_str()), (nullptr));
              },
          .scheduled =
              [this](tactor::Scheduling scheduling, const std::string &text) {
                GST_INFO_OBJECT(element_, "the thread that issues commands: %s (%s)",
                                tactor::to_string(scheduling).data(), text.c_str());
              },
      })
{
}

bool
TactorSession::open(const TactorSettings &settings)
{
  if (!settings.mapping_error.empty()) {
    GST_ELEMENT_ERROR(element_, LIBRARY, SETTINGS,
                      ("mapping cannot be read: %s.", settings.mapping_error.c_str()), (nullptr));
    return false;
  }
  scheduler_.stop(); // of a play whose opening failed
  tl::expected<TactorOpening, tactor::DriverError> prepared = prepare_tactors(element_, settings);
  if (!prepared) {
    tactor_post_open_error(element_, prepared.error());
    return false;
  }
  last_lead_short_.reset();
  // The board's latency is not known yet; that of the last play may well hold.
  gst_base_sink_set_render_delay(
      sink_,
      std::max(gst_base_sink_get_render_delay(sink_),
               lead_of(settings.planner.max_lead, prepared->latency, settings.delay_time())));
  scheduler_.set_immediate(!gst_base_sink_get_sync(sink_));
  const auto open_board = [this, opening = std::make_shared<TactorOpening>(std::move(*prepared))](
                              std::stop_token stop) {
    return open_tactors(
               element_, std::move(*opening),
               [this](const tactor::DriverEvent &event) { device_event(event); }, std::move(stop))
        .map([this](std::pair<OpenTactors, TactorOutput> &&opened) {
          tactors_ = std::move(opened.first);
          agree_on_lead();
          // A mapping is of the film's cells, not of the layout.
          grid_.set(tactors_->planner.mapping.empty() ? tactors_->layout : tactor::Layout{});
          return std::move(opened.second);
        });
  };
  const tl::expected<void, tactor::DriverError> started
      = scheduler_.start(open_board, settings.planner.volts_max, settings.realtime);
  if (!started) {
    tactor_post_open_error(element_, started.error());
    return false;
  }
  return true;
}

void
TactorSession::close()
{
  scheduler_.flush(); // the trace, too
  if (scheduler_.trace_failed())
    GST_ELEMENT_WARNING(element_, RESOURCE, WRITE, ("The command trace is incomplete."),
                        ("writing to it failed: is the disk full?"));
  scheduler_.stop();
}

GstFlowReturn
TactorSession::wait_until_open()
{
  using Outcome = TactorScheduler::Outcome;
  for (Outcome outcome = Outcome::interrupted; outcome != Outcome::open;) {
    const guint64 interruptions = scheduler_.interruptions();
    // Waiting and the query upstream happen without the lock, which a flush needs.
    GST_BASE_SINK_PREROLL_UNLOCK(sink_);
    outcome = scheduler_.wait_until_open(interruptions);
    if (outcome == Outcome::open)
      opened_ = opening_time();
    GST_BASE_SINK_PREROLL_LOCK(sink_);
    if (sink_->flushing || outcome == Outcome::stopped)
      return GST_FLOW_FLUSHING;
    if (outcome == Outcome::failed) { // the error message was posted before
      gst_element_abort_state(element_);
      return GST_FLOW_ERROR;
    }
  }
  return GST_FLOW_OK;
}

/// The clock time now if the source is live, which is certain only now: the lead is agreed on
/// again.
std::optional<GstClockTime>
TactorSession::opening_time()
{
  const bool live = agree_on_lead();
  g_autoptr(GstClock) clock = live ? gst_element_get_clock(element_) : nullptr;
  return clock ? std::optional(gst_clock_get_time(clock)) : std::nullopt;
}

OpenTactors &
TactorSession::tactors()
{
  return *tactors_;
}

bool
TactorSession::is_missed(TactorStream::Span &shown)
{
  if (!opened_)
    return false;
  const Time opened = read_timing().running_time(*opened_);
  const Time first = opened + Time(static_cast<gint64>(gst_base_sink_get_render_delay(sink_)));
  if (opened > Time(0) && shown.start < first) {
    if (shown.end() <= first)
      return true;
    shown = { .start = first, .duration = shown.end() - first };
  }
  opened_.reset();
  return false;
}

TactorTiming
TactorSession::read_timing() const
{
  const guint64 reading = ++readings_;
  const GstClockTimeDiff delay = static_cast<GstClockTimeDiff>(gst_base_sink_get_latency(sink_))
                                 + gst_base_sink_get_ts_offset(sink_) + users_delay_;
  TactorTiming timing(gst_element_get_clock(element_),
                      static_cast<GstClockTimeDiff>(gst_element_get_base_time(element_)) + delay);
  const std::lock_guard lock(timing_mutex_);
  if (reading > reading_) { // else a later one was quicker
    reading_ = reading;
    delay_ = delay;
    timing_ = timing;
  }
  return timing;
}

/// On the scheduler's thread. It does not wait for the object lock, which any thread of the
/// application may have: its holder would get no CPU time on a busy machine while a motor is on.
/// Code that changes latency, ts-offset or delay reads the timing afterwards.
TactorTiming
TactorSession::glance_at_timing() const
{
  const std::lock_guard lock(timing_mutex_);
  if (!GST_OBJECT_TRYLOCK(element_))
    return timing_;
  GstClock *clock = GST_ELEMENT_CLOCK(element_);
  timing_ = TactorTiming(clock ? GST_CLOCK(gst_object_ref(clock)) : nullptr,
                         static_cast<GstClockTimeDiff>(element_->base_time) + delay_);
  GST_OBJECT_UNLOCK(element_);
  return timing_;
}

void
TactorSession::set_delay(Time delay)
{
  users_delay_ = delay.count();
  timing_changed();
}

void
TactorSession::timing_changed()
{
  read_timing();
  scheduler_.timing_changed();
}

const TactorGrid &
TactorSession::grid() const
{
  return grid_;
}

TactorScheduler &
TactorSession::scheduler()
{
  return scheduler_;
}

/// Requests data earlier by the board's latency, once that is known. Returns whether the source is
/// live. Not with the preroll lock: it queries upstream and posts a message.
bool
TactorSession::agree_on_lead()
{
  const bool live = latency::is_live(GST_BASE_SINK_PAD(sink_));
  if (live)
    tactors_->latency = tactors_->live_latency;
  gst_base_sink_set_render_delay(
      sink_, lead_of(tactors_->planner.max_lead, tactors_->latency, Time(users_delay_)));
  return live;
}

/// On any thread of the driver's.
void
TactorSession::device_event(const tactor::DriverEvent &event)
{
  using Kind = tactor::DriverEvent::Kind;
  if (event.kind == Kind::lost || event.kind == Kind::returned)
    scheduler_.set_board_away(event.kind == Kind::lost);
  tactor_post_device_event(element_, event);
}

void
TactorSession::tell_short_lead()
{
  const std::optional<TactorActuation::ShortLead> found = scheduler_.take_short_lead();
  if (!found)
    return;
  const auto [lead, late] = *found;
  GST_DEBUG_OBJECT(element_,
                   "command with a lead of %" GST_STIME_FORMAT " is late by %" GST_STIME_FORMAT,
                   GST_STIME_ARGS(lead.count()), GST_STIME_ARGS(late.count()));
  const Time now(static_cast<gint64>(gst_util_get_timestamp()));
  if (last_lead_short_ && now - *last_lead_short_ < kLeadShortInterval)
    return;
  last_lead_short_ = now;
  tactor_post_lead_short(element_, lead, late);
}
