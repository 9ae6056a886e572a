// SPDX-License-Identifier: LGPL-2.1-or-later
#include "start_watch.h"

#include "gst/cues/film_start.h"

#include <mutex>
#include <string_view>

using visuotactile::Time;

/// What streaming threads find. They may outlive the watch.
struct StartWatch::State
{
  std::mutex mutex;
  FilmStart start{};
  /// Players that do not count from 0:00 show Matroska's own time stamps, and of others the time
  /// that GStreamer shows.
  std::optional<Time> stamp_of_zero{};

  using Shared = std::shared_ptr<State>;

  static void on_source(GstDiscoverer *, GstElement *source, gpointer shared)
  {
    GstObject *bin = gst_object_get_parent(GST_OBJECT(source));
    if (bin == nullptr)
      return;
    connect(bin, "deep-element-added", G_CALLBACK(on_element), shared);
    gst_object_unref(bin);
  }

  static void on_element(GstBin *, GstBin *, GstElement *element, gpointer shared)
  {
    const gchar *kind = gst_element_class_get_metadata(GST_ELEMENT_GET_CLASS(element),
                                                       GST_ELEMENT_METADATA_KLASS);
    if (kind != nullptr && std::string_view(kind).find("Demux") != std::string_view::npos)
      connect(element, "pad-added", G_CALLBACK(on_pad), shared);
  }

  static void on_pad(GstElement *, GstPad *pad, gpointer shared)
  {
    gst_pad_add_probe(pad,
                      static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BUFFER
                                                   | GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM),
                      on_data, new Shared(*static_cast<Shared *>(shared)),
                      [](gpointer data) { delete static_cast<Shared *>(data); });
  }

  static GstPadProbeReturn on_data(GstPad *pad, GstPadProbeInfo *info, gpointer shared)
  {
    State &state = **static_cast<Shared *>(shared);
    if ((GST_PAD_PROBE_INFO_TYPE(info) & GST_PAD_PROBE_TYPE_BUFFER) == 0) {
      GstEvent *event = GST_PAD_PROBE_INFO_EVENT(info);
      if (GST_EVENT_TYPE(event) == GST_EVENT_SEGMENT)
        state.add_segment(pad, event);
      return GST_PAD_PROBE_OK;
    }
    const GstBuffer *buffer = GST_PAD_PROBE_INFO_BUFFER(info);
    if (!GST_BUFFER_PTS_IS_VALID(buffer))
      return GST_PAD_PROBE_OK;
    state.add_first(pad, GST_BUFFER_PTS(buffer));
    return GST_PAD_PROBE_REMOVE;
  }

  void add_segment(GstPad *pad, GstEvent *event)
  {
    const GstSegment *segment = nullptr;
    gst_event_parse_segment(event, &segment);
    const std::lock_guard lock(mutex);
    start.add_segment(*segment);
    g_autoptr(GstElement) demuxer = gst_pad_get_parent_element(pad);
    GstElementFactory *factory = demuxer != nullptr ? gst_element_get_factory(demuxer) : nullptr;
    if (factory != nullptr && segment->format == GST_FORMAT_TIME && !stamp_of_zero
        && std::string_view(GST_OBJECT_NAME(factory)) == "matroskademux")
      stamp_of_zero = Time(static_cast<Time::rep>(segment->start - segment->time));
  }

  void add_first(GstPad *pad, GstClockTime timestamp)
  {
    g_autoptr(GstCaps) caps = gst_pad_get_current_caps(pad);
    g_autoptr(GstEvent) event = gst_pad_get_sticky_event(pad, GST_EVENT_SEGMENT, 0);
    if (caps == nullptr || event == nullptr || gst_caps_is_any(caps) || gst_caps_is_empty(caps))
      return;
    const std::string_view type = gst_structure_get_name(gst_caps_get_structure(caps, 0));
    if (!type.starts_with("video/") && !type.starts_with("audio/") && !type.starts_with("image/"))
      return; // subtitles and data do not show where a film begins
    const GstSegment *segment = nullptr;
    gst_event_parse_segment(event, &segment);
    const std::lock_guard lock(mutex);
    start.add_first(*segment, timestamp);
  }

  static void connect(gpointer object, const char *signal, GCallback handler, gpointer shared)
  {
    g_signal_connect_data(
        object, signal, handler, new Shared(*static_cast<Shared *>(shared)),
        +[](gpointer data, GClosure *) { delete static_cast<Shared *>(data); }, G_CONNECT_DEFAULT);
  }
};

StartWatch::StartWatch(GstDiscoverer *discoverer) : state_(std::make_shared<State>())
{
  State::connect(discoverer, "source-setup", G_CALLBACK(State::on_source), &state_);
}

StartWatch::~StartWatch() = default;

StartTimes
StartWatch::times() const
{
  const std::lock_guard lock(state_->mutex);
  const Time stream = state_->start.stream_time();
  return { .stream = stream,
           .running = state_->start.running_time(),
           .told = state_->stamp_of_zero.value_or(Time(0)) + stream };
}
