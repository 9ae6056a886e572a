// SPDX-License-Identifier: LGPL-2.1-or-later
#include "player.h"

#include "keys.h"
#ifdef HAVE_X11
#include "window.h"
#endif

#include "film/frame_times.h"
#include "film/live_settings.h"
#include "film/pipeline.h"
#include "film/progress.h"
#include "translation.h"

#include <glib-unix.h>
#include <gst/video/navigation.h>
#include <gst/video/video.h>
#include <gst/video/videooverlay.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <utility>
#include <vector>

namespace {

/// How long queued data may play after Ctrl-C.
constexpr guint kDrainSeconds = 3;

/// How long the window shows what a key did.
constexpr guint kWordsSeconds = 3;

/// How long the recording may then take to be completed.
constexpr guint kFinishSeconds = 2;

Stats
stats_of(GstElement *element, const char *name)
{
  GstStructure *stats = nullptr;
  g_object_get(element, name, &stats, nullptr);
  return Stats(stats);
}

/// One run: the pipeline, its main loop and the report.
class Run
{
public:
  Run(const PlaySettings &settings, const Film &film, Strip *strip)
      : settings_(settings), film_(film), strip_(strip), loop_(g_main_loop_new(nullptr, FALSE))
  {
  }

  ~Run()
  {
    for (const guint source : sources_)
      g_source_remove(source);
    if (words_)
      g_source_remove(words_);
    if (timeout_)
      g_source_remove(timeout_);
    pipeline_.reset();
    g_main_loop_unref(loop_);
  }
  Run(const Run &) = delete;
  Run &operator=(const Run &) = delete;

  PlayReport operator()()
  {
    pipeline_ = make_pipeline(launch_line(film_, settings_));
    analysis_ = element(pipeline_, "analysis");
    let_times_advance(Owned<GstPad>(gst_element_get_static_pad(analysis_.get(), "sink")).get());
    chair_ = element(pipeline_, "chair");
    live_.attach(chair_.get());
    if (const Owned<GstElement> recorder = element(pipeline_, "recorder"))
      g_object_set(recorder.get(), "location", settings_.recording.c_str(), nullptr);
    if (!settings_.commands.empty())
      g_object_set(chair_.get(), "trace-location", settings_.commands.c_str(), nullptr);
    if (film_.has_sound)
      g_signal_connect(element(pipeline_, "film").get(), "no-more-pads", G_CALLBACK(no_more_pads),
                       this);
    probe("analysis", "sink", GST_PAD_PROBE_TYPE_BUFFER, gate);
    probe("sound", "sink", GST_PAD_PROBE_TYPE_BUFFER, gate);
    probe("sound", "sink", GST_PAD_PROBE_TYPE_BUFFER, listen);
    probe("overlay", "src", GST_PAD_PROBE_TYPE_BUFFER, watch);
    probe("overlay", "src", GST_PAD_PROBE_TYPE_EVENT_UPSTREAM, pressed);
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
          progress_.is_on_terminal() ? 1 : 5,
          +[](gpointer self) { return static_cast<Run *>(self)->on_progress(); }, this));

    open_window(bus.get());
    if (gst_element_set_state(pipeline_.get(), GST_STATE_PLAYING) != GST_STATE_CHANGE_FAILURE)
      g_main_loop_run(loop_);
    else
      report_.failure = start_error(bus.get());

    gst_element_set_state(pipeline_.get(),
                          GST_STATE_PAUSED); // motors to zero before anything else is taken down
    progress_.clear();
    report_.analysis = stats_of(analysis_.get(), "stats");
    if (settings_.has_trace)
      report_.chair = stats_of(chair_.get(), "actuation-stats");
    gst_element_set_state(pipeline_.get(), GST_STATE_READY);
    check_trace(bus.get());
    gst_element_set_state(pipeline_.get(), GST_STATE_NULL);
    report_.motors_may_run = motors_may_run(chair_.get());
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
    const Owned<GstElement> probed = element(pipeline_, element_name);
    if (!probed)
      return;
    const Owned<GstPad> pad(gst_element_get_static_pad(probed.get(), pad_name));
    gst_pad_add_probe(pad.get(), type, callback, this, nullptr);
  }

  /// As the settings say: the film is shown in ours, not in the sink's.
  void open_window([[maybe_unused]] GstBus *bus)
  {
#ifdef HAVE_X11
    if (settings_.titled)
      window_ = PlayWindow::open(static_cast<int>(film_.width * film_.pixel_aspect), film_.height,
                                 { .pressed = [this](const std::string &key) { on_key(key); },
                                   .changed =
                                       [this] {
                                         if (const Owned<GstElement> sink = shown_by())
                                           gst_video_overlay_expose(GST_VIDEO_OVERLAY(sink.get()));
                                       },
                                   .closed =
                                       [this] {
                                         on_key("q");
                                       } });
    if (!window_)
      return;
    gst_bus_set_sync_handler(
        bus,
        +[](GstBus *, GstMessage *message, gpointer window) { // in a streaming thread
          if (!gst_is_video_overlay_prepare_window_handle_message(message))
            return GST_BUS_PASS;
          GstVideoOverlay *sink = GST_VIDEO_OVERLAY(GST_MESSAGE_SRC(message));
          gst_video_overlay_handle_events(sink, FALSE); // keys are the window's
          gst_video_overlay_set_window_handle(sink, static_cast<PlayWindow *>(window)->handle());
          gst_message_unref(message);
          return GST_BUS_DROP;
        },
        window_.get(), nullptr);
    show_position();
    sources_.push_back(g_timeout_add_seconds(
        1,
        +[](gpointer self) -> gboolean {
          if (static_cast<Run *>(self)->words_ == 0)
            static_cast<Run *>(self)->show_position();
          return G_SOURCE_CONTINUE;
        },
        this));
#endif
  }

  Owned<GstElement> shown_by() const
  {
    return Owned<GstElement>(
        gst_bin_get_by_interface(GST_BIN(pipeline_.get()), GST_TYPE_VIDEO_OVERLAY));
  }

  std::string position_text() const
  {
    return clock_time(shown_.load())
           + (GST_CLOCK_TIME_IS_VALID(film_.duration) ? _(" of ") + clock_time(film_.duration)
                                                      : "");
  }

  void show_position()
  {
    set_title(position_text() + (paused_ ? _(", paused") : ""));
  }

  void set_title([[maybe_unused]] const std::string &what)
  {
#ifdef HAVE_X11
    g_autofree gchar *name = g_path_get_basename(film_.title.c_str());
    if (window_)
      window_->set_title(name + (", " + what));
#endif
  }

  bool is_full_screen() const
  {
#ifdef HAVE_X11
    if (window_)
      return window_->is_full_screen();
#endif
    return false;
  }

  /// Of a sink with a window of its own, only Wayland's knows the whole screen.
  void toggle_full_screen()
  {
#ifdef HAVE_X11
    if (window_)
      return window_->set_full_screen(!window_->is_full_screen());
#endif
    const Owned<GstElement> sink = shown_by();
    if (!sink
        || g_object_class_find_property(G_OBJECT_GET_CLASS(sink.get()), "fullscreen") == nullptr)
      return;
    gboolean full = FALSE;
    g_object_get(sink.get(), "fullscreen", &full, nullptr);
    g_object_set(sink.get(), "fullscreen", !full, nullptr);
  }

  /// Ends the stream here after Ctrl-C. Data that is queued downstream is played and recorded on
  /// time.
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

  /// The film's time.
  static GstClockTime stream_time(GstPad *pad, GstBuffer *buffer)
  {
    GstEvent *event = gst_pad_get_sticky_event(pad, GST_EVENT_SEGMENT, 0);
    if (!event)
      return GST_CLOCK_TIME_NONE;
    const GstSegment *segment;
    gst_event_parse_segment(event, &segment);
    GstClockTime time
        = gst_segment_to_stream_time(segment, GST_FORMAT_TIME, GST_BUFFER_PTS(buffer));
    if (GST_CLOCK_TIME_IS_VALID(time) && segment->time == 0)
      time += segment->base; // of the synthetic film, the second part begins at 0 again
    gst_event_unref(event);
    return time;
  }

  static GstClockTime end_of(GstBuffer *buffer, GstClockTime start)
  {
    return start + (GST_BUFFER_DURATION_IS_VALID(buffer) ? GST_BUFFER_DURATION(buffer) : 1);
  }

  /// Probe for frames with their overlay.
  static GstPadProbeReturn watch(GstPad *pad, GstPadProbeInfo *info, gpointer data)
  {
    Run *self = static_cast<Run *>(data);
    GstBuffer *buffer = GST_PAD_PROBE_INFO_BUFFER(info);
    const GstClockTime time = stream_time(pad, buffer);
    GstCaps *caps = gst_pad_get_current_caps(pad);
    if (caps && GST_CLOCK_TIME_IS_VALID(time)) {
      self->shown_ = time;
      if (self->strip_)
        self->strip_->offer(buffer, caps, time);
      if (self->position_.exchange(end_of(buffer, time)) == 0) {
        if (!self->settings_.quiet)
          std::fprintf(stderr, _("visuotactile-play: %s\n%s '%s'; Ctrl-C ends it\n"),
                       self->settings_.plays_on.c_str(),
                       self->settings_.recording.empty() ? _("Playing")
                                                         : _("Recording, in real time,"),
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

  /// Probe for sound.
  static GstPadProbeReturn listen(GstPad *pad, GstPadProbeInfo *info, gpointer data)
  {
    GstBuffer *buffer = GST_PAD_PROBE_INFO_BUFFER(info);
    const GstClockTime time = stream_time(pad, buffer);
    if (GST_CLOCK_TIME_IS_VALID(time))
      static_cast<Run *>(data)->heard_ = end_of(buffer, time);
    return GST_PAD_PROBE_OK;
  }

  /// Probe for keys that are pressed in the film's window.
  static GstPadProbeReturn pressed(GstPad *, GstPadProbeInfo *info, gpointer data)
  {
    Run *self = static_cast<Run *>(data);
    GstEvent *event = GST_PAD_PROBE_INFO_EVENT(info);
    const gchar *key = nullptr;
    if (GST_EVENT_TYPE(event) != GST_EVENT_NAVIGATION
        || gst_navigation_event_get_type(event) != GST_NAVIGATION_EVENT_KEY_PRESS
        || !gst_navigation_event_parse_key_event(event, &key))
      return GST_PAD_PROBE_OK;
    // The thread is the window's.
    gst_element_post_message(
        self->pipeline_.get(),
        gst_message_new_application(GST_OBJECT(self->pipeline_.get()),
                                    gst_structure_new("key", "name", G_TYPE_STRING, key, nullptr)));
    return GST_PAD_PROBE_OK;
  }

  void on_key(const std::string &key)
  {
    if (key == "f" || (key == "Escape" && is_full_screen())) {
      toggle_full_screen();
    } else if (key == "q" || key == "Escape") {
      report_.stopped = true;
      g_main_loop_quit(loop_);
    } else if (key == "space" || key == "p") {
      paused_ = !paused_;
      gst_element_set_state(pipeline_.get(), paused_ ? GST_STATE_PAUSED : GST_STATE_PLAYING);
      say((paused_ ? _("Paused at ") : _("Playing from ")) + clock_time(shown_.load()));
    } else if (const auto by = seek_of(key)) {
      seek(*by);
    } else if (const std::string line = turn(key, analysis_.get(), chair_.get()); !line.empty()) {
      if (is_steering(key)) {
        g_object_set(analysis_.get(), "attach-saliency", TRUE, nullptr);
        g_object_set(element(pipeline_, "overlay").get(), "meter", TRUE, nullptr);
      }
      say(line);
    }
  }

  void seek(int seconds)
  {
    const auto end = static_cast<gint64>(
        GST_CLOCK_TIME_IS_VALID(film_.duration)
            ? film_.duration - std::min<GstClockTime>(film_.duration, GST_SECOND)
            : G_MAXINT64);
    const gint64 to = std::clamp<gint64>(static_cast<gint64>(shown_.load())
                                             + seconds * static_cast<gint64>(GST_SECOND),
                                         0, std::max(end, static_cast<gint64>(shown_.load())));
    // A sink without a stream would refuse it; the demuxer moves all streams.
    const Owned<GstElement> overlay = element(pipeline_, "overlay");
    // The synthetic film is two that are joined, each with its own time.
    if (film_.uri.empty()
        || !gst_element_seek_simple(
            silent_.load() ? overlay.get() : pipeline_.get(), GST_FORMAT_TIME,
            static_cast<GstSeekFlags>(GST_SEEK_FLAG_FLUSH | GST_SEEK_FLAG_ACCURATE), to)) {
      say(_("This film cannot be moved to another time"));
      return;
    }
    report_.moved = true;
    shown_ = static_cast<GstClockTime>(to); // the next key may come before a frame
    say(position_text());
  }

  void say(const std::string &line)
  {
    if (paused_)
      set_title(line); // no frame will have the words
    else
      show_position();
    if (const Owned<GstElement> words = element(pipeline_, "words")) {
      g_object_set(words.get(), "text", line.c_str(), "silent", FALSE, nullptr);
      if (words_)
        g_source_remove(words_);
      words_ = g_timeout_add_seconds(
          kWordsSeconds,
          +[](gpointer own) -> gboolean {
            Run *self = static_cast<Run *>(own);
            self->words_ = 0;
            g_object_set(element(self->pipeline_, "words").get(), "silent", TRUE, nullptr);
            return G_SOURCE_REMOVE;
          },
          this);
    }
    progress_.clear();
    if (!settings_.quiet)
      std::fprintf(stderr, "%s\n", line.c_str());
  }

  /// Probe for the recording's end of stream, when all has been written.
  static GstPadProbeReturn record(GstPad *, GstPadProbeInfo *info, gpointer data)
  {
    Run *self = static_cast<Run *>(data);
    if (GST_EVENT_TYPE(GST_PAD_PROBE_INFO_EVENT(info)) == GST_EVENT_EOS) {
      self->recorded_ = true;
      self->post("recorded");
    }
    return GST_PAD_PROBE_OK;
  }

  static void no_more_pads(GstElement *, gpointer data)
  {
    Run *self = static_cast<Run *>(data);
    self->silent_ = end_missing_sound(self->pipeline_.get());
  }

  /// Ends the film in order: queued data is played, for kDrainSeconds at the most.
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

  /// Ends the recording without waiting for film or clock. The main loop ends when it is complete.
  void end_at_once()
  {
    if (settings_.recording.empty() || recorded_.load()) {
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
      if (const Owned<GstElement> entry = element(pipeline_, name))
        // Another thread: EOS waits for a streaming thread in the element.
        gst_element_call_async(
            entry.get(),
            +[](GstElement *self, gpointer) {
              const Owned<GstPad> pad(gst_element_get_static_pad(self, "sink"));
              gst_pad_send_event(pad.get(), gst_event_new_eos());
            },
            nullptr, nullptr);
  }

  gboolean on_signal()
  {
    if (std::exchange(report_.stopped, true))
      end_at_once(); // the second Ctrl-C
    else if (paused_)
      end_at_once(); // nothing more is played
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
        report_board();
      } else if (gst_message_has_name(message, "key")) {
        on_key(gst_structure_get_string(gst_message_get_structure(message), "name"));
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
        break; // the warning about the missing decoder is clearer
      progress_.clear();
      std::fprintf(stderr, _("warning: %s\n"), error->message);
      break;
    }
    case GST_MESSAGE_INFO: {
      if (settings_.quiet
          || !gst_object_has_as_ancestor(GST_MESSAGE_SRC(message), GST_OBJECT(chair_.get())))
        break;
      g_autoptr(GError) info = nullptr; // the name of the board, or that there is none
      gst_message_parse_info(message, &info, nullptr);
      board_ = info->message;
      if (playing_) // a film that cannot be played has its error alone
        report_board();
      break;
    }
    case GST_MESSAGE_CLOCK_LOST: // the sound card that was the clock was unplugged
      gst_element_set_state(pipeline_.get(), GST_STATE_PAUSED);
      if (!paused_)
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

  void report_board()
  {
    if (board_.empty())
      return;
    progress_.clear();
    std::fprintf(stderr, "%s\n", std::exchange(board_, {}).c_str());
  }

  /// A film that breaks off is played to where it breaks; anything else that fails is a failure.
  void on_error(GstMessage *message)
  {
    g_autoptr(GError) error = nullptr;
    gst_message_parse_error(message, &error, nullptr);
    const Owned<GstElement> source = element(pipeline_, "film");
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
    const auto seconds = [](GstClockTime time) {
      return static_cast<double>(time) / GST_SECOND;
    };
    g_autofree gchar *of = GST_CLOCK_TIME_IS_VALID(film_.duration)
                               ? g_strdup_printf(_(" of %.1f s"), seconds(film_.duration))
                               : g_strdup("");
    g_autofree gchar *text = g_strdup_printf("%6.1f s%s", seconds(position), of);
    progress_.show(text + counts());
    return G_SOURCE_CONTINUE;
  }

  /// Commands so far, to be appended.
  std::string counts() const
  {
    if (!settings_.has_trace)
      return {};
    g_autoptr(GstStructure) stats = nullptr;
    g_object_get(chair_.get(), "actuation-stats", &stats, nullptr);
    guint64 issued = 0;
    guint64 late = 0;
    if (stats) {
      gst_structure_get_uint64(stats, "issued", &issued);
      gst_structure_get_uint64(stats, "late", &late);
    }
    return "   " + std::to_string(issued) + " commands, " + std::to_string(late) + " late";
  }

  const PlaySettings &settings_;
  const Film &film_;
  Strip *strip_;
  GMainLoop *loop_;
#ifdef HAVE_X11
  std::unique_ptr<PlayWindow> window_; // until the sink is gone
#endif
  Pipeline pipeline_;
  Owned<GstElement> analysis_;
  Owned<GstElement> chair_;
  LiveSettings live_;
  std::vector<guint> sources_;
  guint timeout_ = 0;
  guint words_ = 0; ///< source that ends what a key has shown
  Progress progress_;
  bool playing_ = false; ///< the first frame has come
  std::string board_;    ///< which one is driven, yet to be printed
  bool at_once_ = false;
  bool paused_ = false;
  std::atomic<bool> ending_{ false };
  std::atomic<bool> recorded_{ false };
  std::atomic<bool> silent_{ false };
  std::atomic<GstClockTime> shown_{ 0 };    ///< the film's time of the last frame
  std::atomic<GstClockTime> position_{ 0 }; ///< the film's time at the end of the last frame
  std::atomic<GstClockTime> heard_{ 0 };
  PlayReport report_;
};

} // namespace

PlayReport
play(const Film &film, const PlaySettings &settings, Strip *strip)
{
  return Run(settings, film, strip)();
}
