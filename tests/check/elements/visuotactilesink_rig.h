// SPDX-License-Identifier: LGPL-2.1-or-later
//
// visuotactilesink in a pipeline, with a video sink that records what it was asked for. It defines
// a GObject type, so one source of a program may include it.
#pragma once

#include "tactor/command_trace.h"

#include <string>
#include <utility>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/playing.h"
#include "support/temporary_file.h"
#include "trace.h"
#include <gst/check/gstharness.h>
#include <gst/video/gstvideosink.h>
#include <gst/video/navigation.h>
#include <gst/video/videooverlay.h>

using tactor::IssuedCommand;

/* ---- a video sink for inspection ---- */

struct ShownFrame
{
  GstClockTime running; ///< when it was due, steps included
  guint64 number;       ///< its offset, counted by the source
};

struct TestVideoSink
{
  GstVideoSink parent;
  guintptr handle;
  gint x;
  gint width;
  gint exposed;
  gboolean handles_events;
  gint frames;
  std::string *navigated;
  std::vector<ShownFrame> *shown; ///< to be read when nothing plays
};
struct TestVideoSinkClass
{
  GstVideoSinkClass parent_class;
};

inline gboolean cannot_be_used = FALSE; ///< makes test sinks fail to reach READY

static void test_video_sink_overlay_init(gpointer iface, gpointer);
static void test_video_sink_navigation_init(gpointer iface, gpointer);
GType test_video_sink_get_type(void);
G_DEFINE_TYPE_WITH_CODE(TestVideoSink, test_video_sink, GST_TYPE_VIDEO_SINK,
                        G_IMPLEMENT_INTERFACE(GST_TYPE_VIDEO_OVERLAY, test_video_sink_overlay_init)
                            G_IMPLEMENT_INTERFACE(GST_TYPE_NAVIGATION,
                                                  test_video_sink_navigation_init));

static TestVideoSink *
test_video_sink(gpointer object)
{
  fail_unless(G_TYPE_CHECK_INSTANCE_TYPE(object, test_video_sink_get_type()));
  return reinterpret_cast<TestVideoSink *>(object);
}

static void
test_video_sink_overlay_init(gpointer iface, gpointer)
{
  auto *overlay = static_cast<GstVideoOverlayInterface *>(iface);
  overlay->set_window_handle = [](GstVideoOverlay *self, guintptr handle) {
    test_video_sink(self)->handle = handle;
  };
  overlay->set_render_rectangle = [](GstVideoOverlay *self, gint x, gint, gint width, gint) {
    test_video_sink(self)->x = x;
    test_video_sink(self)->width = width;
  };
  overlay->expose = [](GstVideoOverlay *self) {
    test_video_sink(self)->exposed++;
  };
  overlay->handle_events = [](GstVideoOverlay *self, gboolean handle_events) {
    test_video_sink(self)->handles_events = handle_events;
  };
}

static void
test_video_sink_navigation_init(gpointer iface, gpointer)
{
  static_cast<GstNavigationInterface *>(iface)->send_event_simple
      = [](GstNavigation *self, GstEvent *event) {
          const gchar *key = nullptr;
          gst_navigation_event_parse_key_event(event, &key);
          *test_video_sink(self)->navigated = key;
          gst_event_unref(event);
        };
}

static gboolean
test_video_sink_start(GstBaseSink *sink)
{
  if (cannot_be_used)
    GST_ELEMENT_ERROR(sink, RESOURCE, OPEN_WRITE, ("The test's sink is broken."), (nullptr));
  return !cannot_be_used;
}

static GstStateChangeReturn
test_video_sink_change_state(GstElement *element, GstStateChange transition)
{
  if (transition == GST_STATE_CHANGE_NULL_TO_READY
      && !test_video_sink_start(GST_BASE_SINK(element)))
    return GST_STATE_CHANGE_FAILURE;
  if (transition == GST_STATE_CHANGE_NULL_TO_READY) // like glimagesink
    gst_video_overlay_prepare_window_handle(GST_VIDEO_OVERLAY(element));
  return GST_ELEMENT_CLASS(test_video_sink_parent_class)->change_state(element, transition);
}

static void
test_video_sink_class_init(TestVideoSinkClass *klass)
{
  GstElementClass *element_class = GST_ELEMENT_CLASS(klass);
  gst_element_class_add_pad_template(
      element_class, gst_pad_template_new("sink", GST_PAD_SINK, GST_PAD_ALWAYS,
                                          gst_caps_from_string("video/x-raw(ANY)")));
  gst_element_class_set_static_metadata(element_class, "Test's video sink", "Sink/Video", "Test",
                                        "Test");
  element_class->change_state = test_video_sink_change_state;
  // Count each frame once.
  GST_BASE_SINK_CLASS(klass)->preroll = [](GstBaseSink *, GstBuffer *) {
    return GST_FLOW_OK;
  };
  GST_VIDEO_SINK_CLASS(klass)->show_frame = [](GstVideoSink *sink, GstBuffer *buffer) {
    const GstSegment &segment = GST_BASE_SINK(sink)->segment;
    const GstClockTime pts = GST_BUFFER_PTS(buffer);
    const GstClockTime running
        = gst_segment_to_running_time(&segment, GST_FORMAT_TIME, MAX(pts, segment.start));
    test_video_sink(sink)->shown->push_back(
        { .running = running, .number = GST_BUFFER_OFFSET(buffer) });
    g_atomic_int_inc(&test_video_sink(sink)->frames);
    return GST_FLOW_OK;
  };
  GObjectClass *object_class = G_OBJECT_CLASS(klass);
  object_class->finalize = [](GObject *object) {
    delete test_video_sink(object)->navigated;
    delete test_video_sink(object)->shown;
    G_OBJECT_CLASS(test_video_sink_parent_class)->finalize(object);
  };
  // Stored as the object's data: this sink does not use them otherwise.
  object_class->set_property = [](GObject *object, guint id, const GValue *value, GParamSpec *) {
    if (id == 2)
      g_object_set_data(object, "direction", GINT_TO_POINTER(g_value_get_enum(value)));
    else
      g_object_set_data(object, "ratio", GINT_TO_POINTER(g_value_get_boolean(value) ? 1 : 2));
  };
  object_class->get_property = [](GObject *object, guint id, GValue *value, GParamSpec *) {
    if (id == 2)
      g_value_set_enum(value, GPOINTER_TO_INT(g_object_get_data(object, "direction")));
    else
      g_value_set_boolean(value, GPOINTER_TO_INT(g_object_get_data(object, "ratio")) != 2);
  };
  g_object_class_install_property(
      object_class, 1, g_param_spec_boolean("force-aspect-ratio", "", "", TRUE, G_PARAM_READWRITE));
  g_object_class_install_property( // the name in glimagesink and waylandsink
      object_class, 2,
      g_param_spec_enum("rotate-method", "", "", GST_TYPE_VIDEO_ORIENTATION_METHOD,
                        GST_VIDEO_ORIENTATION_IDENTITY, G_PARAM_READWRITE));
}

static void
test_video_sink_init(TestVideoSink *sink)
{
  sink->handles_events = TRUE;
  sink->navigated = new std::string;
  sink->shown = new std::vector<ShownFrame>;
  // Frames are counted, so none may be dropped on a busy machine.
  gst_base_sink_set_max_lateness(GST_BASE_SINK(sink), -1);
}

/* ---- pipelines ---- */

constexpr GstClockTime kMs = GST_MSECOND;

/// A ball with cues from its first frame on.
inline const std::string kFilm
    = "tactiletestsrc name=source pattern=dynamic-motion num-buffers=60 ! "
      "video/x-raw,format=I420,width=160,height=120,framerate=30/1 ! ";
inline const std::string kSink = "visuotactilesink name=chair driver=simulator "
                                 "analysis::temporal=false tactors::ramp-in=0 ";

inline void
register_test_sink(GstRank rank)
{
  fail_unless(
      gst_element_register(nullptr, "visuotactiletestsink", rank, test_video_sink_get_type()));
}

/// A pipeline with an element `chair`, and the messages on its bus.
class Player
{
public:
  explicit Player(const std::string &description)
  {
    pipeline = make_pipeline(description);
    chair = gst_bin_get_by_name(GST_BIN(pipeline), "chair");
    g_object_set(chair, "trace-location", trace_file.path.c_str(), nullptr);
    bus = gst_element_get_bus(pipeline);
  }
  ~Player()
  {
    gst_element_set_state(pipeline, GST_STATE_NULL);
    gst_object_unref(bus);
    gst_object_unref(chair);
    gst_object_unref(pipeline);
  }
  Player(const Player &) = delete;
  Player &operator=(const Player &) = delete;

  void wait_for_eos()
  {
    for (bool eos = false; !eos;) {
      GstMessage *message = gst_bus_timed_pop(bus, GST_CLOCK_TIME_NONE);
      eos = GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS;
      take(message);
    }
  }
  void play()
  {
    change_state(pipeline, GST_STATE_PLAYING);
    wait_for_eos();
    finish();
  }
  void finish()
  {
    change_state(pipeline, GST_STATE_READY);
    while (GstMessage *message = gst_bus_pop(bus))
      take(message);
    gst_element_set_state(pipeline, GST_STATE_NULL);
  }
  /// The trace, in which each motor's last command must be zero.
  std::vector<IssuedCommand> trace()
  {
    const std::vector<IssuedCommand> lines = unwrap(tactor::read_command_trace(trace_file.path));
    assert_silent_at_end(lines);
    return lines;
  }

  GstElement *pipeline;
  GstElement *chair;
  GstBus *bus;
  TemporaryFile trace_file;
  std::vector<std::pair<std::string, std::string>> warnings; ///< source and text

private:
  void take(GstMessage *message)
  {
    const GstMessageType type = GST_MESSAGE_TYPE(message);
    if (type == GST_MESSAGE_ERROR || type == GST_MESSAGE_WARNING) {
      const Said said(message);
      if (type == GST_MESSAGE_ERROR)
        fail("%s: %s (%s)", GST_MESSAGE_SRC_NAME(message), said.text.c_str(), said.details.c_str());
      warnings.emplace_back(GST_MESSAGE_SRC_NAME(message), said.text);
    }
    gst_message_unref(message);
  }
};

inline GstElement *
shown_by(GstElement *chair)
{
  GstElement *sink = nullptr;
  g_object_get(chair, "video-sink", &sink, nullptr);
  fail_unless(sink != nullptr);
  gst_object_unref(sink); // the bin holds a reference
  return sink;
}

inline guint
commands_with_volts(const std::vector<IssuedCommand> &lines)
{
  guint count = 0;
  for (const IssuedCommand &line : lines)
    count += line.command.volts > 0;
  return count;
}
