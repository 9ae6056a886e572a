// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A stream that follows another one whose end still waits in a queue, as in a gapless play.
#include "visuotactile/twostreams.h"

#include <string>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/playing.h"
#include <gst/check/gstharness.h>

#include "support/check_tests.h"

namespace {

/// Holds the first buffer at a source pad while it lives. What negotiates before it passes.
class Blocked
{
public:
  explicit Blocked(GstElement *element) : pad_(gst_element_get_static_pad(element, "src"))
  {
    id_ = gst_pad_add_probe(
        pad_, static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BLOCK | GST_PAD_PROBE_TYPE_BUFFER),
        [](GstPad *, GstPadProbeInfo *, gpointer) { return GST_PAD_PROBE_OK; }, nullptr, nullptr);
  }
  ~Blocked()
  {
    gst_pad_remove_probe(pad_, id_);
    gst_object_unref(pad_);
  }
  Blocked(const Blocked &) = delete;
  Blocked &operator=(const Blocked &) = delete;

private:
  GstPad *pad_;
  gulong id_;
};

GstCaps *
caps_of(bool jpeg)
{
  return gst_caps_from_string(jpeg ? "image/jpeg,width=16,height=16,framerate=30/1" : "text/x-raw");
}

/// A whole stream of one buffer.
void
push_stream(GstHarness *harness, const char *id, GstBuffer *buffer, bool jpeg)
{
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  g_autoptr(GstCaps) caps = caps_of(jpeg);
  gst_harness_push_event(harness, gst_event_new_stream_start(id));
  gst_harness_push_event(harness, gst_event_new_caps(caps));
  gst_harness_push_event(harness, gst_event_new_segment(&segment));
  buffer = gst_buffer_copy(buffer);
  GST_BUFFER_PTS(buffer) = 0;
  GST_BUFFER_DURATION(buffer) = GST_SECOND / 30;
  fail_unless_equals_int(gst_harness_push(harness, buffer), GST_FLOW_OK);
  gst_harness_push_event(harness, gst_event_new_eos());
}

/// What comes out until the second end: "b" for a buffer, "s" and "e" for beginnings and ends.
std::string
two_streams(GstHarness *harness, GstElement *queue, GstBuffer *buffer, bool jpeg)
{
  {
    const Blocked blocked(queue);
    push_stream(harness, "first", buffer, jpeg);
    push_stream(harness, "second", buffer, jpeg);
  }
  std::string came;
  int ends = 0;
  while (ends < 2) {
    g_autoptr(GstEvent) event = gst_harness_pull_event(harness);
    fail_unless(event != nullptr, "the queue stands still after '%s'", came.c_str());
    if (GST_EVENT_TYPE(event) == GST_EVENT_STREAM_START)
      came += "s";
    if (GST_EVENT_TYPE(event) == GST_EVENT_EOS) {
      came += "e";
      ends++;
    }
  }
  return came + std::string(gst_harness_buffers_received(harness), 'b');
}

GstBuffer *
picture()
{
  GstHarness *encoder = gst_harness_new("jpegenc");
  gst_harness_set_src_caps_str(encoder,
                               "video/x-raw,format=I420,width=16,height=16,framerate=30/1");
  GstBuffer *picture = gst_harness_push_and_pull(
      encoder, gst_buffer_new_allocate(nullptr, 16 * 16 * 3 / 2, nullptr));
  gst_harness_teardown(encoder);
  return picture;
}

} // namespace

CHECK_TEST(test_a_queue)
{
  for (const bool leaks : { false, true }) {
    GstElement *queue = gst_element_factory_make("queue", nullptr);
    if (leaks)
      gst_util_set_object_arg(G_OBJECT(queue), "leaky", "downstream");
    let_streams_follow(queue);
    GstHarness *harness = gst_harness_new_with_element(queue, "sink", "src");
    gst_harness_play(harness);
    g_autoptr(GstBuffer) buffer = gst_buffer_new_allocate(nullptr, 1, nullptr);
    fail_unless(two_streams(harness, queue, buffer, false) == "sesebb");
    gst_harness_teardown(harness);
    gst_object_unref(queue);
  }
}

/// Where the queue refuses data, as after an end, it tells of an end what it would have told.
CHECK_TEST(test_a_refusing_queue)
{
  GstElement *queue = gst_element_factory_make("queue", nullptr);
  let_streams_follow(queue);
  GstHarness *harness = gst_harness_new_with_element(queue, "sink", "src");
  gst_harness_play(harness);
  gst_harness_set_src_caps_str(harness, "text/x-raw");
  gst_element_set_state(queue, GST_STATE_READY);
  fail_if(gst_harness_push_event(harness, gst_event_new_eos()));
  gst_harness_teardown(harness);
  gst_object_unref(queue);
}

/// The picture of the next film goes on in the decoder.
CHECK_TEST(test_the_decoder)
{
  g_autoptr(GstBuffer) frame = picture();
  GstHarness *harness = gst_harness_new("visuotactiledecoder");
  gst_child_proxy_set(GST_CHILD_PROXY(harness->element), "tactors::driver", "simulator", nullptr);
  gst_harness_play(harness);
  g_autoptr(GstElement) queue = gst_bin_get_by_name(GST_BIN(harness->element), "video-queue");
  fail_unless(two_streams(harness, queue, frame, true) == "sesebb");
  gst_harness_teardown(harness);
}

CHECK_MAIN(twostreams)
