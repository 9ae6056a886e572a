// SPDX-License-Identifier: LGPL-2.1-or-later
#include "playback.h"

#include "film/progress.h"
#include "tracks/cue_builder.h"
#include "translation.h"

#include <glib-unix.h>
#include <gst/app/gstappsrc.h>
#include <gst/tactile/tactile.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

/// One run of a main loop.
class Run
{
public:
  Run(GstElement *pipeline, GstClockTime duration, bool quiet)
      : pipeline_(pipeline), duration_(duration), loop_(g_main_loop_new(nullptr, FALSE))
  {
    const Owned<GstBus> bus(gst_element_get_bus(pipeline));
    sources_.push_back(gst_bus_add_watch(
        bus.get(),
        +[](GstBus *, GstMessage *message, gpointer self) {
          return static_cast<Run *>(self)->on_message(message);
        },
        this));
    for (const int number : { SIGINT, SIGTERM })
      sources_.push_back(g_unix_signal_add(
          number,
          +[](gpointer self) -> gboolean {
            static_cast<Run *>(self)->stopped_ = true;
            g_main_loop_quit(static_cast<Run *>(self)->loop_);
            return G_SOURCE_CONTINUE;
          },
          this));
    if (!quiet && progress_.is_on_terminal())
      sources_.push_back(g_timeout_add_seconds(
          1, +[](gpointer self) { return static_cast<Run *>(self)->on_progress(); }, this));
  }
  ~Run()
  {
    gst_element_set_state(pipeline_, GST_STATE_NULL);
    for (const guint source : sources_)
      g_source_remove(source);
    g_main_loop_unref(loop_);
  }
  Run(const Run &) = delete;
  Run &operator=(const Run &) = delete;

  bool operator()()
  {
    if (gst_element_set_state(pipeline_, GST_STATE_PLAYING) != GST_STATE_CHANGE_FAILURE)
      g_main_loop_run(loop_);
    else
      failure_ = start_error(Owned<GstBus>(gst_element_get_bus(pipeline_)).get());
    gst_element_set_state(pipeline_, GST_STATE_NULL);
    progress_.clear();
    if (!failure_.empty())
      throw std::runtime_error(failure_);
    return !stopped_;
  }

private:
  gboolean on_message(GstMessage *message)
  {
    g_autoptr(GError) error = nullptr;
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
      gst_message_parse_error(message, &error, nullptr);
      failure_ = error->message;
    } else if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_WARNING) {
      gst_message_parse_warning(message, &error, nullptr);
      progress_.clear();
      std::fprintf(stderr, _("tactile-track: warning: %s\n"), error->message);
      return G_SOURCE_CONTINUE;
    } else if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_LATENCY) {
      gst_bin_recalculate_latency(GST_BIN(pipeline_));
      return G_SOURCE_CONTINUE;
    } else if (GST_MESSAGE_TYPE(message) != GST_MESSAGE_EOS) {
      return G_SOURCE_CONTINUE;
    }
    g_main_loop_quit(loop_);
    return G_SOURCE_CONTINUE;
  }

  gboolean on_progress()
  {
    gint64 position = 0;
    if (gst_element_query_position(pipeline_, GST_FORMAT_TIME, &position) && duration_ > 0
        && GST_CLOCK_TIME_IS_VALID(duration_))
      progress_.show(std::to_string(std::lround(100 * static_cast<double>(position)
                                                / static_cast<double>(duration_)))
                     + " %");
    return G_SOURCE_CONTINUE;
  }

  GstElement *pipeline_;
  GstClockTime duration_;
  GMainLoop *loop_;
  std::vector<guint> sources_;
  std::string failure_;
  bool stopped_ = false;
  Progress progress_;
};

} // namespace

void
feed_track(GstElement *appsrc, const tactile::Track &track, tactile::Time start)
{
  g_autoptr(GstCaps) caps = gst_tactile_map_caps_new(static_cast<guint>(track.rows()),
                                                     static_cast<guint>(track.columns()), 0, 1);
  g_object_set(appsrc, "caps", caps, "format", GST_FORMAT_TIME, "max-bytes", guint64{ 0 }, nullptr);
  for (tactile::Cue cue : tactile::cues_of(track)) {
    cue.begin = std::max(cue.begin + start, tactile::Time(0));
    cue.end = std::max(cue.end + start, cue.begin);
    gst_app_src_push_buffer(GST_APP_SRC(appsrc), cue_buffer_new(cue, CueForm::map));
  }
  gst_app_src_end_of_stream(GST_APP_SRC(appsrc));
}

bool
run_to_end(const Pipeline &pipeline, GstClockTime duration, bool quiet)
{
  return Run(pipeline.get(), duration, quiet)();
}
