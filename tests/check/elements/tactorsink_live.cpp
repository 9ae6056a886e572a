// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Devices behind servers in a live stream, whose picture waits for them all the time.
#include "tactor/command_trace.h"

#include <algorithm>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "server_rig.h"
#include "support/temporary_file.h"
#include "trace.h"

#include "support/check_tests.h"

/// The picture of a live source waits all the time: for twice what the opening measured, not for
/// the longest that is possible. Nothing leads by more than that.
CHECK_TEST(test_latency_of_a_live_source)
{
  GstPad *source = gst_pad_new("src", GST_PAD_SRC);
  gst_pad_set_query_function(source, [](GstPad *, GstObject *, GstQuery *query) -> gboolean {
    if (GST_QUERY_TYPE(query) != GST_QUERY_LATENCY)
      return FALSE;
    gst_query_set_latency(query, TRUE, 0, GST_CLOCK_TIME_NONE);
    return TRUE;
  });
  for (const Case &one : kCases) {
    const TemporaryFile trace;
    ServerRig rig(one.driver, one.device, { one.kind, "slow=1", "gap=1" });
    g_object_set(rig.element, "compensation", 0, "trace-location", trace.path.c_str(), nullptr);
    fail_unless(gst_pad_link(source, rig.sink_pad) == GST_PAD_LINK_OK);
    rig.start(1, 1);
    const tactor::Time agreed = rig.room();
    fail_unless(agreed >= std::chrono::milliseconds(40) && agreed < std::chrono::milliseconds(150),
                "%ld ns", long{ agreed.count() });
    // A server that becomes slower than that.
    rig.server.say("slow=160");
    rig.play_until_latency(150, 150);
    ck_assert_int_eq(rig.push({ 1 }), GST_FLOW_OK);
    ck_assert_int_eq(rig.push({ 0 }), GST_FLOW_OK);
    fail_unless(rig.room() == agreed);
    gst_element_set_state(rig.element, GST_STATE_NULL);
    gst_pad_unlink(source, rig.sink_pad);
    fail_unless(std::ranges::max(leads_of_zeros(trace.path)) == agreed);
  }
  gst_object_unref(source);
}

/// A live film is shown while the device is opened. All sinks wait for the device from then on.
CHECK_TEST(test_latency_of_a_live_film)
{
  constexpr GstClockTime kLeast = (180 + 10 + 20 + 2 * 60) * GST_MSECOND;
  HapticServer server({ "bhaptics", "slow=60" });
  GstElement *pipeline = make_pipeline(
      "videotestsrc is-live=true ! video/x-raw,width=64,height=48,framerate=30/1 ! jpegenc ! "
      "visuotactiledecoder tactors::driver=bhaptics tactors::device="
      + server.device("visor") + " ! fakesink name=picture sync=true");
  g_autoptr(GstElement) picture = gst_bin_get_by_name(GST_BIN(pipeline), "picture");
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  while (gst_base_sink_get_latency(GST_BASE_SINK(picture)) < kLeast) {
    g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(
        bus, GST_CLOCK_TIME_NONE,
        static_cast<GstMessageType>(GST_MESSAGE_LATENCY | GST_MESSAGE_ERROR));
    ck_assert_int_eq(GST_MESSAGE_TYPE(message), GST_MESSAGE_LATENCY);
    gst_bin_recalculate_latency(GST_BIN(pipeline));
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
}

CHECK_MAIN(tactorsink_live)
