// SPDX-License-Identifier: LGPL-2.1-or-later
#include "player.h"

#include "gst/video/video_sinks.h"

#include <glib-unix.h>
#include <gst/video/video.h>

#include <algorithm>
#include <atomic>
#include <cinttypes>
#include <csignal>
#include <cstdio>
#include <memory>
#include <utility>
#include <vector>

namespace {

/// How long the end may take once it was asked for; then the film ends where it is.
constexpr guint kDrainSeconds = 3;

/// How long the recording may take to be completed then.
constexpr guint kFinishSeconds = 2;

struct Unref
{
  void operator()(gpointer object) const
  {
    gst_object_unref(object);
  }
};
template <typename T> using Owned = std::unique_ptr<T, Unref>;

/// One run: the pipeline, its main loop and what happened.
class Run
{
public:
  Run(const PlaySettings &settings, const Film &film, Strip &strip)
      : settings_(settings), film_(film), strip_(strip), loop_(g_main_loop_new(nullptr, FALSE))
  {
  }

  ~Run()
  {
    for (const guint source : sources_)
      g_source_remove(source);
    if (timeout_)
      g_source_remove(timeout_);
    if (pipeline_)
      gst_element_set_state(pipeline_.get(), GST_STATE_NULL);
    g_main_loop_unref(loop_);
  }
  Run(const Run &) = delete;
  Run &operator=(const Run &) = delete;

  PlayReport operator()()
  {
    g_autoptr(GError) error = nullptr;
    pipeline_.reset(gst_parse_launch_full(launch_line(film_, settings_).c_str(), nullptr,
                                          GST_PARSE_FLAG_FATAL_ERRORS, &error));
    if (!pipeline_) {
      report_.failure = std::string("cannot build the pipeline: ") + error->message;
      return std::move(report_);
    }
    analysis_.reset(gst_bin_get_by_name(GST_BIN(pipeline_.get()), "analysis"));
    chair_.reset(gst_bin_get_by_name(GST_BIN(pipeline_.get()), "chair"));
    const Owned<GstElement> recorder(gst_bin_get_by_name(GST_BIN(pipeline_.get()), "recorder"));
    if (recorder)
      g_object_set(recorder.get(), "location", settings_.recording.c_str(), nullptr);
    g_object_set(chair_.get(), "trace-location", settings_.commands.c_str(), nullptr);
    const Owned<GstElement> source(gst_bin_get_by_name(GST_BIN(pipeline_.get()), "film"));
    if (film_.has_sound)
      g_signal_connect(source.get(), "no-more-pads", G_CALLBACK(no_more_pads), this);
    probe("analysis", "sink", GST_PAD_PROBE_TYPE_BUFFER, gate);
    probe("sound", "sink", GST_PAD_PROBE_TYPE_BUFFER, gate);
    probe("sound", "sink", GST_PAD_PROBE_TYPE_BUFFER, listen);
    probe("overlay", "src", GST_PAD_PROBE_TYPE_BUFFER, watch);
    probe("recorder", "sink", GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM, record);

    const Owned<GstBus> bus(gst_element_get_bus(pipeline_.get()));
    sources_.push_back(gst_bus_add_watch(
        bus.get(),
        +[](GstBus *, GstMessage *message, gpointer self) {
          return static_cast<Run *>(self)->on_message(message);
        },
        this));
    for (const int number : { SIGINT, SIGTERM, SIGHUP })
      sources_.push_back(g_unix_signal_add(
          number, +[](gpointer self) { return static_cast<Run *>(self)->on_signal(); }, this));
    if (!settings_.quiet)
      sources_.push_back(g_timeout_add_seconds(
          settings_.progress_in_place ? 1 : 5,
          +[](gpointer self) { return static_cast<Run *>(self)->on_progress(); }, this));

    if (gst_element_set_state(pipeline_.get(), GST_STATE_PLAYING) != GST_STATE_CHANGE_FAILURE)
      g_main_loop_run(loop_);
    else
      explain_failure(bus.get());

    gst_element_set_state(pipeline_.get(),
                          GST_STATE_PAUSED); // motors to zero before anything else is taken down
    if (settings_.progress_in_place && progress_shown_)
      std::fputs("\r\033[K", stderr);
    if (analysis_)
      g_object_get(analysis_.get(), "stats", &report_.analysis, nullptr);
    if (chair_)
      g_object_get(chair_.get(), "actuation-stats", &report_.chair, nullptr);
    gst_element_set_state(pipeline_.get(), GST_STATE_READY);
    check_trace(bus.get());
    gst_element_set_state(pipeline_.get(), GST_STATE_NULL);
    report_.position = position_.load();
    report_.reached = std::max(report_.position, heard_.load());
    report_.recorded = recorded_.load();
    report_.silent = silent_.load();
    report_.played = report_.position > 0;
    return std::move(report_);
  }

private:
  void probe(const char *element_name, const char *pad_name, GstPadProbeType type,
             GstPadProbeCallback callback)
  {
    const Owned<GstElement> element(gst_bin_get_by_name(GST_BIN(pipeline_.get()), element_name));
    if (!element)
      return;
    const Owned<GstPad> pad(gst_element_get_static_pad(element.get(), pad_name));
    gst_pad_add_probe(pad.get(), type, callback, this, nullptr);
  }

  /// Ends the stream here once that was asked for: what is behind is played and written to its end,
  /// on time.
  static GstPadProbeReturn gate(GstPad *pad, GstPadProbeInfo *info, gpointer data)
  {
    Run *self = static_cast<Run *>(data);
    if (!self->ending_.load())
      return GST_PAD_PROBE_OK;
    gst_buffer_unref(GST_PAD_PROBE_INFO_BUFFER(info));
    GST_PAD_PROBE_INFO_DATA(info) = nullptr;
    gst_pad_send_event(pad, gst_event_new_eos());
    GST_PAD_PROBE_INFO_FLOW_RETURN(info) = GST_FLOW_EOS;
    return GST_PAD_PROBE_HANDLED;
  }

  /// A film is played once, forward, from its beginning, and parts that are put together follow
  /// each other.
  static GstClockTime running_time(GstPad *pad, GstBuffer *buffer)
  {
    GstEvent *event = gst_pad_get_sticky_event(pad, GST_EVENT_SEGMENT, 0);
    if (!event)
      return GST_CLOCK_TIME_NONE;
    const GstSegment *segment;
    gst_event_parse_segment(event, &segment);
    const GstClockTime time
        = gst_segment_to_running_time(segment, GST_FORMAT_TIME, GST_BUFFER_PTS(buffer));
    gst_event_unref(event);
    return time;
  }

  static GstClockTime end_of(GstBuffer *buffer, GstClockTime start)
  {
    return start + (GST_BUFFER_DURATION_IS_VALID(buffer) ? GST_BUFFER_DURATION(buffer) : 1);
  }

  /// Sees each frame with its overlay.
  static GstPadProbeReturn watch(GstPad *pad, GstPadProbeInfo *info, gpointer data)
  {
    Run *self = static_cast<Run *>(data);
    GstBuffer *buffer = GST_PAD_PROBE_INFO_BUFFER(info);
    const GstClockTime time = running_time(pad, buffer);
    GstCaps *caps = gst_pad_get_current_caps(pad);
    if (caps && GST_CLOCK_TIME_IS_VALID(time)) {
      self->strip_.offer(buffer, caps, time);
      if (self->position_.exchange(end_of(buffer, time)) == 0) {
        if (!self->settings_.quiet)
          std::fprintf(stderr, "%s '%s'; Ctrl-C ends it\n",
                       self->settings_.window ? "Playing" : "Recording, in real time,",
                       self->film_.title.c_str());
        self->post("playing");
      }
    }
    if (caps)
      gst_caps_unref(caps);
    return GST_PAD_PROBE_OK;
  }

  void post(const char *what)
  {
    gst_element_post_message(
        pipeline_.get(),
        gst_message_new_application(GST_OBJECT(pipeline_.get()), gst_structure_new_empty(what)));
  }

  /// Sees each piece of sound.
  static GstPadProbeReturn listen(GstPad *pad, GstPadProbeInfo *info, gpointer data)
  {
    GstBuffer *buffer = GST_PAD_PROBE_INFO_BUFFER(info);
    const GstClockTime time = running_time(pad, buffer);
    if (GST_CLOCK_TIME_IS_VALID(time))
      static_cast<Run *>(data)->heard_ = end_of(buffer, time);
    return GST_PAD_PROBE_OK;
  }

  /// Sees what is written: when its end comes, all else has been.
  static GstPadProbeReturn record(GstPad *, GstPadProbeInfo *info, gpointer data)
  {
    Run *self = static_cast<Run *>(data);
    if (GST_EVENT_TYPE(GST_PAD_PROBE_INFO_EVENT(info)) == GST_EVENT_EOS) {
      self->recorded_ = true;
      self->post("recorded");
    }
    return GST_PAD_PROBE_OK;
  }

  /// All that the film has is linked now. Sound that can't be decoded is not: the recording must
  /// not wait for it.
  static void no_more_pads(GstElement *, gpointer data)
  {
    Run *self = static_cast<Run *>(data);
    const Owned<GstElement> queue(gst_bin_get_by_name(GST_BIN(self->pipeline_.get()), "heard"));
    const Owned<GstPad> pad(gst_element_get_static_pad(queue.get(), "sink"));
    if (gst_pad_is_linked(pad.get()))
      return;
    self->silent_ = true;
    gst_pad_send_event(pad.get(), gst_event_new_stream_start("no sound"));
    gst_pad_send_event(pad.get(), gst_event_new_eos());
  }

  /// Ends the film in order: what was read of it is played. If that takes too long, at once.
  void end()
  {
    ending_ = true;
    if (!timeout_)
      timeout_ = g_timeout_add_seconds(
          kDrainSeconds,
          +[](gpointer data) {
            Run *self = static_cast<Run *>(data);
            self->timeout_ = 0;
            self->end_at_once();
            return G_SOURCE_REMOVE;
          },
          this);
  }

  /// Ends the recording where it is, without waiting for the film or the clock; the main loop ends
  /// when it is complete.
  void end_at_once()
  {
    if (settings_.window || recorded_.load()) {
      g_main_loop_quit(loop_);
      return;
    }
    if (std::exchange(at_once_, true))
      return;
    if (timeout_)
      g_source_remove(timeout_);
    timeout_ = g_timeout_add_seconds(
        kFinishSeconds,
        +[](gpointer data) {
          Run *self = static_cast<Run *>(data);
          self->timeout_ = 0;
          g_main_loop_quit(self->loop_);
          return G_SOURCE_REMOVE;
        },
        this);
    for (const char *name : { "overlay", "sound" })
      if (const Owned<GstElement> element{ gst_bin_get_by_name(GST_BIN(pipeline_.get()), name) })
        // Not from here: an element that is at work would be waited for.
        gst_element_call_async(
            element.get(),
            +[](GstElement *self, gpointer) {
              const Owned<GstPad> pad(gst_element_get_static_pad(self, "sink"));
              gst_pad_send_event(pad.get(), gst_event_new_eos());
            },
            nullptr, nullptr);
  }

  gboolean on_signal()
  {
    if (std::exchange(report_.stopped, true))
      end_at_once(); // asked twice
    else
      end();
    return G_SOURCE_CONTINUE;
  }

  gboolean on_message(GstMessage *message)
  {
    switch (GST_MESSAGE_TYPE(message)) {
    case GST_MESSAGE_APPLICATION:
      if (gst_message_has_name(message, "playing")) {
        playing_ = true;
        tell_about_chair();
      } else if (at_once_) // the recording is complete
        g_main_loop_quit(loop_);
      break;
    case GST_MESSAGE_EOS:
      g_main_loop_quit(loop_);
      break;
    case GST_MESSAGE_ERROR:
      on_error(message);
      break;
    case GST_MESSAGE_WARNING: {
      g_autoptr(GError) error = nullptr;
      gst_message_parse_warning(message, &error, nullptr);
      if (g_error_matches(error, GST_PARSE_ERROR, GST_PARSE_ERROR_DELAYED_LINK))
        break; // the warning about the decoder that is missing says it better
      std::fprintf(stderr, "%swarning: %s\n", settings_.progress_in_place ? "\r\033[K" : "",
                   error->message);
      break;
    }
    case GST_MESSAGE_INFO: {
      if (settings_.quiet || GST_MESSAGE_SRC(message) != GST_OBJECT(chair_.get()))
        break;
      g_autoptr(GError) info = nullptr; // which board, or that there is none
      gst_message_parse_info(message, &info, nullptr);
      about_chair_ = info->message;
      if (playing_) // of a film that cannot be played, only that is said
        tell_about_chair();
      break;
    }
    case GST_MESSAGE_CLOCK_LOST: // a sound card that was unplugged took its clock along
      gst_element_set_state(pipeline_.get(), GST_STATE_PAUSED);
      gst_element_set_state(pipeline_.get(), GST_STATE_PLAYING);
      break;
    case GST_MESSAGE_LATENCY:
      gst_bin_recalculate_latency(GST_BIN(pipeline_.get()));
      break;
    default:
      break;
    }
    return G_SOURCE_CONTINUE;
  }

  void tell_about_chair()
  {
    if (const std::string told = std::exchange(about_chair_, {}); !told.empty())
      std::fprintf(stderr, "%s%s\n", settings_.progress_in_place ? "\r\033[K" : "", told.c_str());
  }

  /// A film that breaks off is played to where it breaks; anything else that fails is a failure.
  void on_error(GstMessage *message)
  {
    g_autoptr(GError) error = nullptr;
    gst_message_parse_error(message, &error, nullptr);
    const Owned<GstElement> source(gst_bin_get_by_name(GST_BIN(pipeline_.get()), "film"));
    const bool from_film
        = source
          && (GST_MESSAGE_SRC(message) == GST_OBJECT(source.get())
              || gst_object_has_as_ancestor(GST_MESSAGE_SRC(message), GST_OBJECT(source.get())));
    const bool window_closed
        = settings_.window
          && g_error_matches(error, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_NOT_FOUND)
          && GST_OBJECT_FLAG_IS_SET(GST_MESSAGE_SRC(message), GST_ELEMENT_FLAG_SINK);
    if (window_closed) {
      report_.stopped = true;
      g_main_loop_quit(loop_);
    } else if (from_film && position_.load() > 0) {
      report_.ended_early = error->message;
      end();
    } else {
      const bool from_recorder = g_str_equal(GST_MESSAGE_SRC_NAME(message), "recorder");
      report_.failure
          = std::string(from_recorder ? "cannot write the recording: " : "") + error->message;
      g_main_loop_quit(loop_);
    }
  }

  /// tactorsink completes its trace as it stops, and warns if it could not.
  /// Why the pipeline did not start: what an element said, if any did.
  void explain_failure(GstBus *bus)
  {
    report_.failure = "the pipeline could not be started";
    if (GstMessage *message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR)) {
      g_autoptr(GError) error = nullptr;
      gst_message_parse_error(message, &error, nullptr);
      report_.failure = error->message;
      gst_message_unref(message);
    }
  }

  void check_trace(GstBus *bus)
  {
    while (GstMessage *message = gst_bus_pop_filtered(bus, GST_MESSAGE_WARNING)) {
      g_autoptr(GError) error = nullptr;
      gst_message_parse_warning(message, &error, nullptr);
      if (GST_MESSAGE_SRC(message) == GST_OBJECT(chair_.get()) && report_.failure.empty()
          && g_error_matches(error, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_WRITE))
        report_.failure = std::string("cannot write the commands: ") + error->message;
      gst_message_unref(message);
    }
  }

  gboolean on_progress()
  {
    const GstClockTime position = position_.load();
    GstStructure *stats = nullptr;
    g_object_get(chair_.get(), "actuation-stats", &stats, nullptr);
    guint64 issued = 0;
    guint64 late = 0;
    if (stats) {
      gst_structure_get_uint64(stats, "issued", &issued);
      gst_structure_get_uint64(stats, "late", &late);
      gst_structure_free(stats);
    }
    const auto seconds = [](GstClockTime time) {
      return static_cast<double>(time) / GST_SECOND;
    };
    std::fprintf(stderr, "%s%6.1f s", settings_.progress_in_place ? "\r\033[K" : "",
                 seconds(position));
    if (GST_CLOCK_TIME_IS_VALID(film_.duration))
      std::fprintf(stderr, " of %.1f s", seconds(film_.duration));
    std::fprintf(stderr, "   %" PRIu64 " commands, %" PRIu64 " late%s",
                 static_cast<std::uint64_t>(issued), static_cast<std::uint64_t>(late),
                 settings_.progress_in_place ? "" : "\n");
    std::fflush(stderr);
    progress_shown_ = true;
    return G_SOURCE_CONTINUE;
  }

  const PlaySettings &settings_;
  const Film &film_;
  Strip &strip_;
  GMainLoop *loop_;
  Owned<GstElement> pipeline_;
  Owned<GstElement> analysis_;
  Owned<GstElement> chair_;
  std::vector<guint> sources_;
  guint timeout_ = 0;
  bool progress_shown_ = false;
  bool playing_ = false;    ///< the first frame has come
  std::string about_chair_; ///< what is still to be told
  bool at_once_ = false;
  std::atomic<bool> ending_{ false };
  std::atomic<bool> recorded_{ false };
  std::atomic<bool> silent_{ false };
  std::atomic<GstClockTime> position_{ 0 };
  std::atomic<GstClockTime> heard_{ 0 };
  PlayReport report_;
};

} // namespace

PlayReport::~PlayReport()
{
  if (analysis)
    gst_structure_free(analysis);
  if (chair)
    gst_structure_free(chair);
}

PlayReport::PlayReport(PlayReport &&other) noexcept
    : played(other.played), stopped(other.stopped), recorded(other.recorded), silent(other.silent),
      failure(std::move(other.failure)), ended_early(std::move(other.ended_early)),
      position(other.position), reached(other.reached),
      analysis(std::exchange(other.analysis, nullptr)), chair(std::exchange(other.chair, nullptr))
{
}

bool
have_display()
{
  if (!g_getenv("DISPLAY") && !g_getenv("WAYLAND_DISPLAY"))
    return false;
  // autovideosink would try it.
  if (GstPluginFeature *feature
      = gst_registry_lookup_feature(gst_registry_get(), kCrashingVideoSink)) {
    gst_plugin_feature_set_rank(feature, GST_RANK_NONE);
    gst_object_unref(feature);
  }
  // autovideosink opens the best sink that works, or settles for a fake one.
  const Owned<GstElement> sink(gst_element_factory_make("autovideosink", nullptr));
  if (!sink)
    return false;
  gst_object_ref_sink(sink.get());
  bool found = false;
  if (gst_element_set_state(sink.get(), GST_STATE_READY) != GST_STATE_CHANGE_FAILURE) {
    GstIterator *children = gst_bin_iterate_elements(GST_BIN(sink.get()));
    GValue item = G_VALUE_INIT;
    while (gst_iterator_next(children, &item) == GST_ITERATOR_OK) {
      const GstElementFactory *factory
          = gst_element_get_factory(GST_ELEMENT(g_value_get_object(&item)));
      found = factory && !g_str_has_prefix(GST_OBJECT_NAME(factory), "fake");
      g_value_unset(&item);
    }
    gst_iterator_free(children);
  }
  gst_element_set_state(sink.get(), GST_STATE_NULL);
  return found;
}

PlayReport
play(const Film &film, const PlaySettings &settings, Strip &strip)
{
  return Run(settings, film, strip)();
}
