// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stage.h"

#include <stdexcept>

namespace {

const std::string kRoom = " ! queue max-size-bytes=0 max-size-buffers=0 max-size-time=400000000 ";
const std::string kBranches
    = " ! saliencytactile name=analysis temporal=false ! tactileextractor name=x x.src" + kRoom
      + "! fakesink name=video sync=true qos=true x.tactile" + kRoom
      + "name=branch ! tactorsink name=tactors";
const std::string kCamera
    = "tactiletestsrc name=source is-live=true pattern=dynamic-motion ! capsfilter name=size "
      "caps-change-mode=delayed caps=video/x-raw,format=I420,width=160,height=120,framerate=30/1";

GstElement *
parse(const std::string &line)
{
  GError *error = nullptr;
  GstElement *pipeline = gst_parse_launch(line.c_str(), &error);
  if (!error)
    return pipeline;
  const std::string reason = error->message;
  g_error_free(error);
  gst_clear_object(&pipeline);
  throw std::runtime_error(reason + ": " + line);
}

GstElement *
named(GstElement *bin, const char *name)
{
  return gst_bin_get_by_name(GST_BIN(bin), name);
}

} // namespace

Stage::Stage(Kind kind, const std::string &film) : kind(kind)
{
  switch (kind) {
  case Kind::file:
    pipeline = parse("filesrc location=" + film
                     + " ! decodebin name=decoder videoscale name=scale ! capsfilter name=size "
                       "caps-change-mode=delayed"
                     + kBranches);
    link_decoder();
    break;
  case Kind::live:
    pipeline = parse(kCamera + kBranches);
    break;
  case Kind::network: {
    pipeline = parse("udpsrc name=maps address=127.0.0.1 port=0 "
                     "caps=\"application/x-rtp,media=application,clock-rate=90000,"
                     "encoding-name=X-GST\" ! rtpjitterbuffer latency=100 ! rtpgstdepay "
                     "! tactorsink name=tactors rate=0");
    // The port is known after it was opened.
    GstElement *maps = named(pipeline, "maps");
    gst_element_set_state(maps, GST_STATE_READY);
    gint port = 0;
    g_object_get(maps, "port", &port, nullptr);
    g_object_set(maps, "port", port, nullptr);
    gst_object_unref(maps);
    source = parse(kCamera
                   + " ! saliencytactile temporal=false ! tactileextractor name=x x.src "
                     "! fakesink sync=true async=false x.tactile ! rtpgstpay config-interval=1 "
                     "! udpsink name=out host=127.0.0.1 sync=true async=false port="
                   + std::to_string(port));
    gst_element_set_state(source, GST_STATE_PLAYING);
    break;
  }
  case Kind::decoder:
    pipeline = parse("filesrc location=" + film
                     + " ! matroskademux name=decoder visuotactiledecoder name=scale ! queue "
                       "max-size-bytes=0 max-size-time=0 max-size-buffers=3 ! "
                       "fakesink name=video sync=true qos=true");
    link_decoder();
    break;
  case Kind::playbin: {
    pipeline = parse("playbin uri=file://" + film
                     + " audio-sink=\"fakesink sync=true\" "
                       "video-sink=\"visuotactilesink name=chair video-sink=fakesink\"");
    GstElement *chair = nullptr;
    g_object_get(pipeline, "video-sink", &chair, nullptr);
    tactors = named(chair, "tactors");
    analysis = named(chair, "analysis");
    GstElement *video = nullptr;
    g_object_get(chair, "video-sink", &video, nullptr);
    g_object_set(video, "sync", TRUE, "qos", TRUE, nullptr);
    gst_object_unref(video);
    gst_object_unref(chair);
    break;
  }
  }
  if (!tactors)
    tactors = named(pipeline, "tactors");
  if (!analysis)
    analysis = named(pipeline, "analysis");
  size = named(source ? source : pipeline, "size");
  branch = named(pipeline, "branch");
  if (analysis)
    g_object_set(analysis, "temporal", FALSE, nullptr);
}

/// Links at each start: gst_parse_launch() does so only once.
void
Stage::link_decoder()
{
  GstElement *decoder = named(pipeline, "decoder");
  GstElement *scale = named(pipeline, "scale");
  g_signal_connect(decoder, "pad-added",
                   G_CALLBACK(+[](GstElement *, GstPad *pad, GstElement *scale) {
                     GstPad *sink = gst_element_get_static_pad(scale, "sink");
                     gst_pad_link(pad, sink); // refused for sound
                     gst_object_unref(sink);
                   }),
                   scale); // lives in the same bin
  gst_object_unref(scale);
  gst_object_unref(decoder);
}

Stage::~Stage()
{
  for (GstElement **each : { &source, &pipeline })
    if (*each)
      gst_element_set_state(*each, GST_STATE_NULL);
  for (GstElement **each : { &tactors, &analysis, &size, &branch, &source, &pipeline })
    gst_clear_object(each);
}

GstPad *
Stage::upstream_pad() const
{
  GstPad *sink = gst_element_get_static_pad(tactors, "sink");
  GstPad *peer = gst_pad_get_peer(sink);
  gst_object_unref(sink);
  return peer;
}

bool
Stage::is_at_end() const
{
  gboolean ended = FALSE;
  g_autoptr(GstIterator) all = gst_bin_iterate_recurse(GST_BIN(pipeline));
  gst_iterator_foreach(
      all,
      [](const GValue *item, gpointer ended) {
        gst_element_foreach_pad(
            GST_ELEMENT(g_value_get_object(item)),
            [](GstElement *, GstPad *pad, gpointer ended) -> gboolean {
              *static_cast<gboolean *>(ended) |= GST_PAD_IS_EOS(pad);
              return TRUE;
            },
            ended);
      },
      &ended);
  return ended;
}

void
make_film(const std::string &path)
{
  GstElement *pipeline
      = parse("tactiletestsrc pattern=dynamic-motion num-buffers=360 ! "
              "video/x-raw,format=I420,width=160,height=120,framerate=30/1 ! jpegenc ! "
              "matroskamux name=mux ! filesink location="
              + path
              + " audiotestsrc num-buffers=517 ! audio/x-raw,format=S16LE,rate=44100,channels=1 "
                "! mux.");
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  GstBus *bus = gst_element_get_bus(pipeline);
  GstMessage *message = gst_bus_timed_pop_filtered(
      bus, GST_CLOCK_TIME_NONE, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  const bool ended = GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS;
  gst_message_unref(message);
  gst_object_unref(bus);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
  if (!ended)
    throw std::runtime_error("the film could not be made");
}
