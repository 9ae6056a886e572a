// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Frames whose times do not advance.
#include "film/frame_times.h"

#include <initializer_list>

#include "support/check_tests.h"

namespace {

constexpr GstClockTime kNone = GST_CLOCK_TIME_NONE;

/// Times in ms.
struct Frame
{
  GstClockTime comes;
  GstClockTime duration;
  GstClockTime goes;
};

GstClockTime
ms(GstClockTime time)
{
  return time == kNone ? kNone : time * GST_MSECOND;
}

/// A pad to push to, the pad with the times, and the time that goes on.
class Stream
{
public:
  explicit Stream(const gchar *caps)
      : source_(gst_pad_new("source", GST_PAD_SRC)), sink_(gst_pad_new("sink", GST_PAD_SINK))
  {
    gst_pad_set_element_private(sink_, this);
    gst_pad_set_chain_function(sink_, on_buffer);
    let_times_advance(sink_);
    gst_pad_set_active(source_, TRUE);
    gst_pad_set_active(sink_, TRUE);
    fail_unless_equals_int(gst_pad_link(source_, sink_), GST_PAD_LINK_OK);
    gst_pad_push_event(source_, gst_event_new_stream_start("film"));
    g_autoptr(GstCaps) of = gst_caps_from_string(caps);
    gst_pad_push_event(source_, gst_event_new_caps(of));
    begin();
  }
  ~Stream()
  {
    gst_pad_set_active(source_, FALSE);
    gst_pad_set_active(sink_, FALSE);
    gst_object_unref(source_);
    gst_object_unref(sink_);
  }
  Stream(const Stream &) = delete;
  Stream &operator=(const Stream &) = delete;

  void begin()
  {
    GstSegment segment;
    gst_segment_init(&segment, GST_FORMAT_TIME);
    gst_pad_push_event(source_, gst_event_new_segment(&segment));
  }

  void expect(std::initializer_list<Frame> frames)
  {
    for (const Frame &frame : frames) {
      GstBuffer *buffer = gst_buffer_new();
      GST_BUFFER_PTS(buffer) = ms(frame.comes);
      GST_BUFFER_DURATION(buffer) = ms(frame.duration);
      fail_unless_equals_int(gst_pad_push(source_, buffer), GST_FLOW_OK);
      fail_unless_equals_clocktime(last_, ms(frame.goes));
    }
  }

private:
  static GstFlowReturn on_buffer(GstPad *pad, GstObject *, GstBuffer *buffer)
  {
    static_cast<Stream *>(gst_pad_get_element_private(pad))->last_ = GST_BUFFER_PTS(buffer);
    gst_buffer_unref(buffer);
    return GST_FLOW_OK;
  }

  GstPad *source_;
  GstPad *sink_;
  GstClockTime last_ = kNone;
};

} // namespace

/// Of an animation, each frame with another duration, all at 0.
CHECK_TEST(test_all_at_zero)
{
  Stream stream("video/x-raw");
  stream.expect({ { 0, 100, 0 }, { 0, 30, 100 }, { 0, 500, 130 }, { 0, 100, 630 } });
}

/// Frames without a time, by their duration or the frame rate; times that come count again.
CHECK_TEST(test_without_times)
{
  Stream stream("video/x-raw,framerate=25/1");
  stream.expect({ { 1000, kNone, 1000 },
                  { kNone, kNone, 1040 },
                  { kNone, 60, 1080 },
                  { 1160, kNone, 1160 },
                  { 1200, kNone, 1200 } });
  // What nobody knows stays as it is.
  Stream unknown("video/x-raw");
  unknown.expect({ { kNone, kNone, kNone }, { 5, kNone, 5 }, { 5, kNone, 5 } });
}

/// After a seek to the same frame it has its time again.
CHECK_TEST(test_seek)
{
  Stream stream("video/x-raw");
  stream.expect({ { 200, 40, 200 } });
  stream.begin();
  stream.expect({ { 200, 40, 200 }, { 240, 40, 240 } });
}

CHECK_MAIN(frame_times)
