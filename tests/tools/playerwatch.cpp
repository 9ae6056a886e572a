// SPDX-License-Identifier: LGPL-2.1-or-later
//
// playerwatch: a tracer that writes down when a player's video sinks show their frames, and has the
// commands of each tactorsink traced. The player is as its package installed it:
//
//   GST_TRACERS=playerwatch PLAYERWATCH=FOLDER PLAYER FILM
//
// FOLDER/watch-PROCESS.csv has a line for each frame that is shown, EOS and flush:
// sink,kind,running_ns,shown_ns,film_ns,width,height. A frame's running time is that of its time
// stamp, `shown` that of the sink's clock when the sink begins to show it. Commands of the
// tactorsink SINK from its START on are in commands-PROCESS-SINK-START.csv, in running times of the
// same pipeline.
#define GST_USE_UNSTABLE_API
#include <gst/base/gstbasesink.h>
#include <gst/gst.h>
#include <gst/gsttracer.h>

#include <cstdio>
#include <map>
#include <mutex>
#include <string>
#include <unistd.h>

namespace {

using Render = GstFlowReturn (*)(GstBaseSink *, GstBuffer *);

std::mutex mutex;
std::map<GstBaseSinkClass *, Render> renders; ///< of the classes themselves; under the mutex
FILE *lines = nullptr;                        ///< under the mutex
GQuark number;                                ///< of a sink
int sinks = 0;                                ///< under the mutex
int starts = 0;                               ///< under the mutex

struct Size
{
  int width = 0;
  int height = 0;
};

std::string
file_in_folder(const std::string &name)
{
  return std::string(g_getenv("PLAYERWATCH")) + "/" + name + ".csv";
}

int
number_of(gpointer sink)
{
  return GPOINTER_TO_INT(g_object_get_qdata(G_OBJECT(sink), number));
}

void
write_line(GstBaseSink *sink, const char *kind, Size size, gint64 running = -1, gint64 shown = -1,
           gint64 film = -1)
{
  std::lock_guard lock(mutex);
  if (lines == nullptr)
    return;
  std::fprintf(lines,
               "%d,%s,%" G_GINT64_FORMAT ",%" G_GINT64_FORMAT ",%" G_GINT64_FORMAT ",%d,%d\n",
               number_of(sink), kind, running, shown, film, size.width, size.height);
  std::fflush(lines);
}

/// Of a video sink's frames; 0 for other streams.
Size
video_size(GstBaseSink *sink)
{
  g_autoptr(GstCaps) caps = gst_pad_get_current_caps(GST_BASE_SINK_PAD(sink));
  if (caps == nullptr || gst_caps_is_empty(caps) || gst_caps_is_any(caps))
    return {};
  const GstStructure *structure = gst_caps_get_structure(caps, 0);
  Size size;
  if (gst_structure_has_name(structure, "video/x-raw"))
    gst_structure_get(structure, "width", G_TYPE_INT, &size.width, "height", G_TYPE_INT,
                      &size.height, nullptr);
  return size;
}

GstFlowReturn
watched_render(GstBaseSink *sink, GstBuffer *frame)
{
  const Size size = video_size(sink);
  g_autoptr(GstClock) clock = gst_element_get_clock(GST_ELEMENT(sink));
  if (size.width > 0 && clock && GST_BUFFER_PTS_IS_VALID(frame)) {
    const auto shown = static_cast<gint64>(gst_clock_get_time(clock)
                                           - gst_element_get_base_time(GST_ELEMENT(sink)));
    const GstSegment *segment = &sink->segment;
    const GstClockTime time = GST_BUFFER_PTS(frame);
    write_line(sink, "frame", size,
               static_cast<gint64>(gst_segment_to_running_time(segment, GST_FORMAT_TIME, time)),
               shown,
               static_cast<gint64>(gst_segment_to_stream_time(segment, GST_FORMAT_TIME, time)));
  }
  Render render = nullptr;
  {
    std::lock_guard lock(mutex);
    render = renders[GST_BASE_SINK_GET_CLASS(sink)];
  }
  return render(sink, frame);
}

GstPadProbeReturn
on_event(GstPad *pad, GstPadProbeInfo *info, gpointer)
{
  g_autoptr(GstElement) sink = gst_pad_get_parent_element(pad);
  const GstEventType type = GST_EVENT_TYPE(GST_PAD_PROBE_INFO_EVENT(info));
  if (sink && (type == GST_EVENT_EOS || type == GST_EVENT_FLUSH_STOP))
    write_line(GST_BASE_SINK(sink), gst_event_type_get_name(type), video_size(GST_BASE_SINK(sink)));
  return GST_PAD_PROBE_OK;
}

bool
is_tactor_sink(GstElement *element)
{
  return g_str_equal(G_OBJECT_TYPE_NAME(element), "GstTactorSink");
}

/// Any thread. A chair that changes hands starts a tactorsink again.
void
on_state(GObject *, GstClockTime, GstElement *element, GstStateChange transition)
{
  if (transition != GST_STATE_CHANGE_READY_TO_PAUSED || !is_tactor_sink(element))
    return;
  std::string trace
      = "commands-" + std::to_string(getpid()) + "-" + std::to_string(number_of(element)) + "-";
  {
    std::lock_guard lock(mutex);
    trace = file_in_folder(trace + std::to_string(++starts));
  }
  g_object_set(element, "trace-location", trace.c_str(), nullptr);
}

/// Any thread.
void
on_added(GObject *, GstClockTime, GstBin *, GstElement *element, gboolean added)
{
  if (!added || !GST_IS_BASE_SINK(element) || number_of(element) != 0)
    return;
  {
    std::lock_guard lock(mutex);
    g_object_set_qdata(G_OBJECT(element), number, GINT_TO_POINTER(++sinks));
    if (lines == nullptr) {
      lines = std::fopen(file_in_folder("watch-" + std::to_string(getpid())).c_str(), "we");
      if (lines == nullptr)
        g_critical("playerwatch: cannot write in the folder PLAYERWATCH");
    }
  }
  if (!is_tactor_sink(element)) {
    std::lock_guard lock(mutex);
    GstBaseSinkClass *klass = GST_BASE_SINK_GET_CLASS(element);
    if (klass->render && renders.emplace(klass, klass->render).second)
      klass->render = watched_render;
  }
  gst_pad_add_probe(GST_BASE_SINK_PAD(element),
                    static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM
                                                 | GST_PAD_PROBE_TYPE_EVENT_FLUSH),
                    on_event, nullptr, nullptr);
}

} // namespace

struct PlayerWatch
{
  GstTracer parent;
};

struct PlayerWatchClass
{
  GstTracerClass parent_class;
};

G_DEFINE_TYPE(PlayerWatch, player_watch, GST_TYPE_TRACER)

static void
player_watch_class_init(PlayerWatchClass *)
{
  number = g_quark_from_static_string("playerwatch");
}

static void
player_watch_init(PlayerWatch *self)
{
  if (g_getenv("PLAYERWATCH") == nullptr)
    return;
  gst_tracing_register_hook(GST_TRACER(self), "bin-add-post", G_CALLBACK(on_added));
  gst_tracing_register_hook(GST_TRACER(self), "element-change-state-pre", G_CALLBACK(on_state));
}

static gboolean
plugin_init(GstPlugin *plugin)
{
  return gst_tracer_register(plugin, "playerwatch", player_watch_get_type());
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, playerwatch,
                  "Writes down when a player shows its frames; for tests", plugin_init,
                  PACKAGE_VERSION, "LGPL", PACKAGE_NAME, PACKAGE_ORIGIN)
