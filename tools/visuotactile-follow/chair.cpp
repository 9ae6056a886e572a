// SPDX-License-Identifier: LGPL-2.1-or-later
#include "chair.h"

#include "gst/cues/cue_stream.h"

#include <gst/app/gstappsrc.h>
#include <gst/base/gstbasesink.h>
#include <gst/tactile/tactile.h>

#include <algorithm>
#include <stdexcept>

namespace {

/// Longest delay of the main loop.
constexpr follow::Time kSlack = std::chrono::milliseconds(150);

std::string
text_of(GstMessage *message, void (*parse)(GstMessage *, GError **, gchar **))
{
  g_autoptr(GError) error = nullptr;
  parse(message, &error, nullptr);
  return error->message;
}

} // namespace

Chair::Chair(std::string sink, Events events)
    : sink_line_(std::move(sink)), events_(std::move(events))
{
}

Chair::~Chair()
{
  close();
}

void
Chair::open(int rows, int columns)
{
  const bool is_open = pipeline_ != nullptr;
  if (!is_open) {
    pipeline_
        = make_pipeline("appsrc name=track format=time is-live=true max-bytes=0 min-latency=0 "
                        "max-latency=1000000000 ! "
                        + sink_line_ + " name=chair");
    source_ = element(pipeline_, "track");
    sink_ = element(pipeline_, "chair");
    live_.attach(sink_.get());
    // Running time is the local time of reports, also in the trace.
    const Owned<GstClock> clock(GST_CLOCK(
        g_object_new(GST_TYPE_SYSTEM_CLOCK, "clock-type", GST_CLOCK_TYPE_MONOTONIC, nullptr)));
    gst_object_ref_sink(clock.get());
    gst_pipeline_use_clock(GST_PIPELINE(pipeline_.get()), clock.get());
    gst_element_set_start_time(pipeline_.get(), GST_CLOCK_TIME_NONE);
    gst_element_set_base_time(pipeline_.get(), 0);
    const Owned<GstBus> bus(gst_element_get_bus(pipeline_.get()));
    watch_ = gst_bus_add_watch(
        bus.get(),
        +[](GstBus *, GstMessage *message, gpointer self) {
          return static_cast<Chair *>(self)->on_message(message);
        },
        this);
  }
  g_autoptr(GstCaps) caps
      = gst_tactile_map_caps_new(static_cast<guint>(rows), static_cast<guint>(columns), 0, 1);
  gst_app_src_set_caps(GST_APP_SRC(source_.get()), caps);
  if (is_open
      || gst_element_set_state(pipeline_.get(), GST_STATE_PLAYING) != GST_STATE_CHANGE_FAILURE)
    return;
  const std::string error = start_error(Owned<GstBus>(gst_element_get_bus(pipeline_.get())).get());
  close();
  throw std::runtime_error(error);
}

void
Chair::close()
{
  if (watch_ != 0)
    g_source_remove(watch_);
  watch_ = 0;
  live_.attach(nullptr);
  source_.reset();
  sink_.reset();
  pipeline_.reset();
}

follow::Time
Chair::ahead() const
{
  if (!sink_)
    return kSlack;
  gdouble delay = 0; // ms
  g_object_get(sink_.get(), "delay", &delay, nullptr);
  return kSlack + follow::Time(static_cast<gint64>(std::max(-delay, 0.0) * 1e6))
         + follow::Time(gst_base_sink_get_render_delay(GST_BASE_SINK(sink_.get())));
}

/// Cancels the latency of the pipeline, since cues are known ahead of time.
void
Chair::undo_latency()
{
  auto *sink = GST_BASE_SINK(sink_.get());
  const auto offset = -static_cast<GstClockTimeDiff>(gst_base_sink_get_latency(sink));
  if (gst_base_sink_get_ts_offset(sink) != offset)
    g_object_set(sink, "ts-offset", offset, nullptr);
}

/// Running time continues through all seeks.
void
Chair::take(const follow::TrackFollower::Step &step)
{
  if (!pipeline_)
    return;
  undo_latency();
  if (step.silence) {
    gst_element_send_event(source_.get(), gst_event_new_flush_start());
    gst_element_send_event(source_.get(), gst_event_new_flush_stop(FALSE));
  }
  for (const tactile::Cue &cue : step.cues)
    gst_app_src_push_buffer(GST_APP_SRC(source_.get()), cue_buffer_new(cue, CueForm::map));
}

gboolean
Chair::on_message(GstMessage *message)
{
  switch (GST_MESSAGE_TYPE(message)) {
  case GST_MESSAGE_ERROR:
    events_.failed(text_of(message, gst_message_parse_error));
    break;
  case GST_MESSAGE_WARNING:
    events_.told("warning: " + text_of(message, gst_message_parse_warning));
    break;
  case GST_MESSAGE_INFO:
    events_.told(text_of(message, gst_message_parse_info));
    break;
  case GST_MESSAGE_LATENCY:
    gst_bin_recalculate_latency(GST_BIN(pipeline_.get()));
    break;
  default:
    break;
  }
  return G_SOURCE_CONTINUE;
}
