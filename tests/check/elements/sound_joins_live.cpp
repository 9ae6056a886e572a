// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A chair that waits for the sound of live sources, or for one that never comes.
#include <future>
#include <string>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/playing.h"
#include <gst/base/gstbasesink.h>

#include "support/check_tests.h"

// A chair whose sound never comes plays the picture.
CHECK_TEST(test_sound_that_never_comes)
{
  GstElement *pipeline = make_pipeline(
      "tactiletestsrc pattern=dynamic-motion num-buffers=30 ! "
      "video/x-raw,format=I420,width=160,height=120,framerate=30/1 ! visuotactilesink name=chair "
      "driver=simulator video-sink=\"fakesink sync=true\" appsrc is-live=true format=time "
      "caps=audio/x-raw,format=F32LE,rate=48000,channels=1,layout=interleaved ! soundtactile ! "
      "fakesink async=false");
  g_autoptr(GstElement) chair = gst_bin_get_by_name(GST_BIN(pipeline), "chair");
  // The pipeline's end would wait for that of the sound.
  const auto ended = +[](GstPad *, GstPadProbeInfo *info, gpointer promise) {
    if (GST_EVENT_TYPE(GST_PAD_PROBE_INFO_EVENT(info)) == GST_EVENT_EOS)
      static_cast<std::promise<void> *>(promise)->set_value();
    return GST_PAD_PROBE_OK;
  };
  std::promise<void> end;
  g_autoptr(GstElement) tactors
      = GST_ELEMENT(gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(chair), "tactors"));
  g_autoptr(GstPad) pad = gst_element_get_static_pad(tactors, "sink");
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM, ended, &end, nullptr);
  change_state(pipeline, GST_STATE_PLAYING);
  end.get_future().wait();
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
}

// Of a live source, all are later by the frames that the maps wait for their sound: as many as 95
// ms need, and of long ones as many as are in that time.
CHECK_LOOP_TEST(test_live_latency, 0, 3)
{
  struct Rate
  {
    const char *text;
    GstClockTime later;
  };
  const Rate rates[] = { { "30/1", 100000000 }, { "24/1", 125000000 }, { "12/1", 83333333 } };
  const Rate &rate = rates[__i__];
  GstClockTime latency[2] = {};
  for (const bool sounds : { false, true }) {
    GstElement *pipeline = make_pipeline(
        std::string("videotestsrc is-live=true ! "
                    "video/x-raw,format=I420,width=160,height=120,framerate=")
        + rate.text + " ! visuotactilesink name=chair driver=simulator video-sink=fakesink sound="
        + (sounds ? "film" : "off")
        + " audiotestsrc is-live=true ! soundtactile ! fakesink name=speakers sync=true");
    g_autoptr(GstElement) speakers = gst_bin_get_by_name(GST_BIN(pipeline), "speakers");
    g_autoptr(GstElement) analysis = gst_bin_get_by_name(GST_BIN(pipeline), "analysis");
    g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
    change_state(pipeline, GST_STATE_PLAYING);
    // The framerate is known with the first frame. Applications do this on LATENCY messages.
    while (stat_of(analysis, "frames") < 5) {
      g_autoptr(GstMessage) error
          = gst_bus_timed_pop_filtered(bus, 10 * GST_MSECOND, GST_MESSAGE_ERROR);
      fail_unless(error == nullptr);
    }
    fail_unless(gst_bin_recalculate_latency(GST_BIN(pipeline)));
    latency[sounds] = gst_base_sink_get_latency(GST_BASE_SINK(speakers));
    gst_element_set_state(pipeline, GST_STATE_NULL);
    gst_object_unref(pipeline);
  }
  const auto off = static_cast<gint64>(latency[true] - latency[false] - rate.later);
  fail_unless(ABS(off) <= 3, "%" G_GINT64_FORMAT " ns off", off); // rounded in each frame
}

/// An application hears a LATENCY message, and all sinks wait longer from then on.
CHECK_LOOP_TEST(test_switched_on_while_live, 0, 2)
{
  struct Chair
  {
    const char *line;
    const char *property;
    GstClockTime more;
  };
  const Chair chairs[] = {
    { "visuotactilesink name=chair driver=simulator video-sink=fakesink sound=off", "sound",
      3 * (GST_SECOND / 30) },
    { "jpegenc ! visuotactiledecoder name=chair tactors::driver=simulator sound::sound=off ! "
      "fakesink sync=true",
      "sound::sound", 137 * GST_MSECOND },
  };
  const Chair &chair = chairs[__i__];
  GstElement *pipeline = make_pipeline(
      std::string("videotestsrc is-live=true ! "
                  "video/x-raw,format=I420,width=160,height=120,framerate=30/1 ! ")
      + chair.line
      + " audiotestsrc is-live=true ! soundtactile ! fakesink name=speakers sync=true");
  g_autoptr(GstElement) speakers = gst_bin_get_by_name(GST_BIN(pipeline), "speakers");
  g_autoptr(GstElement) element = gst_bin_get_by_name(GST_BIN(pipeline), "chair");
  g_autoptr(GstElement) analysis
      = GST_ELEMENT(gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(element), "analysis"));
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  change_state(pipeline, GST_STATE_PLAYING);
  while (stat_of(analysis, "frames") < 5) {
    g_autoptr(GstMessage) error
        = gst_bus_timed_pop_filtered(bus, 10 * GST_MSECOND, GST_MESSAGE_ERROR);
    fail_unless(error == nullptr);
  }
  fail_unless(gst_bin_recalculate_latency(GST_BIN(pipeline)));
  const GstClockTime before = gst_base_sink_get_latency(GST_BASE_SINK(speakers));
  while (GstMessage *told = gst_bus_pop(bus))
    gst_message_unref(told);
  gst_child_proxy_set(GST_CHILD_PROXY(element), chair.property, 1, nullptr);
  g_autoptr(GstMessage) told
      = gst_bus_timed_pop_filtered(bus, GST_CLOCK_TIME_NONE, GST_MESSAGE_LATENCY);
  fail_unless(told != nullptr);
  fail_unless(gst_bin_recalculate_latency(GST_BIN(pipeline)));
  fail_unless_equals_uint64(gst_base_sink_get_latency(GST_BASE_SINK(speakers)),
                            before + chair.more);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
}

CHECK_MAIN(sound_joins_live)
