// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gst/fusion/later_maps.h"
#include "gst/fusion/sound_meta.h"
#include "support/check_tests.h"

#include <gst/check/gstharness.h>
#include <gst/tactile/tactile.h>
#include <gst/video/video.h>

#include <array>
#include <string>
#include <vector>

#include "support/playing.h"

namespace {

constexpr const gchar *kVideoCaps = "video/x-raw,format=GRAY8,width=8,height=8,framerate=25/1";
constexpr GstClockTime kFrame = 40 * GST_MSECOND;

/// The element with a harness on each of its source pads. Either may be left out.
class Extractor
{
public:
  explicit Extractor(bool with_video = true, bool with_tactile = true,
                     const gchar *caps = kVideoCaps)
      : element_(gst_element_factory_make("tactileextractor", nullptr)),
        video(gst_harness_new_with_element(element_, "sink", with_video ? "src" : nullptr)),
        tactile(with_tactile ? gst_harness_new_with_element(element_, nullptr, "tactile") : nullptr)
  {
    if (caps != nullptr)
      gst_harness_set_src_caps_str(video, caps);
  }

  ~Extractor()
  {
    if (tactile != nullptr)
      gst_harness_teardown(tactile);
    gst_harness_teardown(video);
    gst_object_unref(element_);
  }

  Extractor(const Extractor &) = delete;
  Extractor &operator=(const Extractor &) = delete;

private:
  GstElement *element_;

public:
  GstHarness *video;
  GstHarness *tactile;
};

GstBuffer *
make_frame(guint number, guint rows = 0, guint columns = 0)
{
  GstBuffer *frame = gst_buffer_new_allocate(nullptr, 64, nullptr);
  GST_BUFFER_PTS(frame) = number * kFrame;
  GST_BUFFER_DURATION(frame) = kFrame;
  if (rows > 0) {
    std::vector<gfloat> levels(std::size_t{ rows } * columns);
    for (std::size_t i = 0; i < levels.size(); i++)
      levels[i] = static_cast<gfloat>((i + number) % 8) / 8;
    gst_buffer_add_tactile_meta(frame, rows, columns, levels.data(), levels.size());
  }
  return frame;
}

void
assert_map(GstBuffer *map, guint number, guint rows, guint columns)
{
  fail_unless(map != nullptr);
  fail_unless_equals_uint64(GST_BUFFER_PTS(map), number * kFrame);
  fail_unless_equals_uint64(GST_BUFFER_DURATION(map), kFrame);
  gfloat *levels = nullptr;
  gsize n = 0;
  fail_unless(gst_tactile_map_buffer_get_levels(map, rows, columns, &levels, &n));
  for (gsize i = 0; i < n; i++)
    fail_unless_equals_float(levels[i], static_cast<gfloat>((i + number) % 8) / 8);
  g_free(levels);
  gst_buffer_unref(map);
}

/// Names of the events since the last call, in order. Caps are followed by grid and rate.
std::string
events(GstHarness *h)
{
  std::string names;
  while (GstEvent *event = gst_harness_try_pull_event(h)) {
    names += names.empty() ? "" : " ";
    names += GST_EVENT_TYPE_NAME(event);
    if (GST_EVENT_TYPE(event) == GST_EVENT_CAPS) {
      GstCaps *caps = nullptr;
      guint rows = 0;
      guint columns = 0;
      gint n = 0;
      gint d = 0;
      gst_event_parse_caps(event, &caps);
      if (gst_tactile_map_caps_parse(caps, &rows, &columns, &n, &d))
        names += ":" + std::to_string(rows) + "x" + std::to_string(columns) + "@"
                 + std::to_string(n) + "/" + std::to_string(d);
    }
    gst_event_unref(event);
  }
  return names;
}

#define ASSERT_EVENTS(h, expected)                                                                 \
  G_STMT_START                                                                                     \
  {                                                                                                \
    const std::string came = events(h);                                                            \
    fail_unless_equals_string(came.c_str(), expected);                                             \
  }                                                                                                \
  G_STMT_END

GstFlowReturn
push(Extractor &e, GstBuffer *frame)
{
  return gst_harness_push(e.video, frame);
}

} // namespace

CHECK_TEST(test_frame_and_map)
{
  Extractor e;
  GstBuffer *frame = make_frame(0, 2, 3);
  GstMemory *memory = gst_buffer_peek_memory(frame, 0);
  const GstBuffer *same = frame;
  fail_unless_equals_int(push(e, frame), GST_FLOW_OK);

  ASSERT_EVENTS(e.tactile, "stream-start caps:2x3@25/1 segment");
  ASSERT_EVENTS(e.video, "stream-start caps segment");
  GstBuffer *out = gst_harness_pull(e.video);
  fail_unless(out == same && gst_buffer_peek_memory(out, 0) == memory);
  ASSERT_BUFFER_REFCOUNT(out, "frame", 1); // the map does not hold a reference
  fail_unless(gst_buffer_get_tactile_meta(out) != nullptr);
  gst_buffer_unref(out);
  GstBuffer *map = gst_harness_pull(e.tactile);
  fail_unless_equals_int(gst_buffer_n_memory(map), 1);
  assert_map(map, 0, 2, 3);
}

CHECK_TEST(test_stream_ids)
{
  Extractor e;
  fail_unless_equals_int(push(e, make_frame(0, 3, 3)), GST_FLOW_OK);
  GstEvent *video = gst_harness_pull_event(e.video);
  GstEvent *tactile = gst_harness_pull_event(e.tactile);
  const gchar *video_id = nullptr;
  const gchar *tactile_id = nullptr;
  gst_event_parse_stream_start(video, &video_id);
  gst_event_parse_stream_start(tactile, &tactile_id);
  fail_unless(g_str_has_prefix(tactile_id, video_id) && !g_str_equal(tactile_id, video_id));
  gst_event_unref(video);
  gst_event_unref(tactile);

  // Both streams get upstream's group id.
  const guint group = gst_util_group_id_next();
  GstEvent *start = gst_event_new_stream_start("film");
  gst_event_set_group_id(start, group);
  while (GstEvent *event = gst_harness_try_pull_event(e.tactile))
    gst_event_unref(event);
  fail_unless(gst_harness_push_event(e.video, start));
  tactile = gst_harness_pull_event(e.tactile);
  guint got = 0;
  fail_unless(gst_event_parse_group_id(tactile, &got));
  fail_unless_equals_int(got, group);
  gst_event_parse_stream_start(tactile, &tactile_id);
  fail_unless_equals_string(tactile_id, "film/tactile");
  gst_event_unref(tactile);
}

CHECK_TEST(test_caps_changes)
{
  Extractor e;
  push(e, make_frame(0, 2, 3));
  push(e, make_frame(1, 2, 3));
  ASSERT_EVENTS(e.tactile, "stream-start caps:2x3@25/1 segment");
  push(e, make_frame(2, 3, 2)); // the same number of levels
  ASSERT_EVENTS(e.tactile, "caps:3x2@25/1");
  gst_harness_set_src_caps_str(e.video,
                               "video/x-raw,format=GRAY8,width=8,height=8,framerate=30000/1001");
  push(e, make_frame(3, 3, 2));
  ASSERT_EVENTS(e.tactile, "segment caps:3x2@30000/1001");
  gst_harness_set_src_caps_str(e.video,
                               "video/x-raw,format=GRAY8,width=4,height=16,framerate=30000/1001");
  push(e, make_frame(4, 3, 2)); // a change of size does not change the maps' caps
  ASSERT_EVENTS(e.tactile, "segment");
  gst_harness_set_src_caps_str(e.video, "video/x-raw,format=GRAY8,width=4,height=16");
  push(e, make_frame(5, 64, 64));
  ASSERT_EVENTS(e.tactile, "segment caps:64x64@0/1");

  const std::array<std::pair<guint, guint>, 6> grids{
    { { 2, 3 }, { 2, 3 }, { 3, 2 }, { 3, 2 }, { 3, 2 }, { 64, 64 } }
  };
  for (guint i = 0; i < grids.size(); i++)
    assert_map(gst_harness_pull(e.tactile), i, grids[i].first, grids[i].second);
  fail_unless_equals_int(gst_harness_buffers_received(e.video), 6);
}

CHECK_TEST(test_gaps)
{
  Extractor e;
  push(e, make_frame(0)); // no grid is known yet, so it is the paper's
  ASSERT_EVENTS(e.tactile, "stream-start caps:3x3@25/1 segment gap");
  push(e, make_frame(1, 4, 6));
  ASSERT_EVENTS(e.tactile, "caps:4x6@25/1");
  push(e, make_frame(2));
  GstEvent *gap = gst_harness_pull_event(e.tactile);
  GstClockTime time = 0;
  GstClockTime duration = 0;
  gst_event_parse_gap(gap, &time, &duration);
  fail_unless_equals_uint64(time, 2 * kFrame);
  fail_unless_equals_uint64(duration, kFrame);
  gst_event_unref(gap);
  ASSERT_EVENTS(e.tactile, "");
  fail_unless_equals_int(gst_harness_buffers_received(e.tactile), 1);
  fail_unless_equals_int(gst_harness_buffers_received(e.video), 3);

  events(e.video);
  fail_unless(gst_harness_push_event(e.video, gst_event_new_gap(3 * kFrame, kFrame)));
  ASSERT_EVENTS(e.tactile, "gap");
  ASSERT_EVENTS(e.video, "gap");
}

CHECK_TEST(test_grid_that_downstream_wants)
{
  Extractor e(true, true, nullptr);
  gst_harness_set_sink_caps_str(e.tactile, "application/x-tactile-map,rows=[4,8],columns=7");
  gst_harness_set_src_caps_str(e.video, kVideoCaps);
  push(e, make_frame(0));
  ASSERT_EVENTS(e.tactile, "stream-start caps:4x7@25/1 segment gap");
}

CHECK_TEST(test_end_of_stream)
{
  Extractor e;
  fail_unless(
      gst_harness_push_event(e.video, gst_event_new_eos())); // a sink that waits for data needs it
  ASSERT_EVENTS(e.tactile, "stream-start caps:3x3@25/1 segment eos");
  ASSERT_EVENTS(e.video, "stream-start caps segment eos");
}

CHECK_TEST(test_flush_and_segment)
{
  Extractor e;
  push(e, make_frame(0, 3, 3));
  events(e.tactile);
  events(e.video);
  fail_unless(gst_harness_push_event(e.video, gst_event_new_flush_start()));
  fail_unless_equals_int(push(e, make_frame(1, 3, 3)), GST_FLOW_FLUSHING);
  fail_unless(gst_harness_push_event(e.video, gst_event_new_flush_stop(TRUE)));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.rate = 2;
  segment.start = segment.time = segment.position = 10 * kFrame;
  fail_unless(gst_harness_push_event(e.video, gst_event_new_segment(&segment)));
  fail_unless_equals_int(push(e, make_frame(10, 3, 3)), GST_FLOW_OK);

  for (GstHarness *h : { e.video, e.tactile }) {
    GstEvent *event = nullptr;
    for (const GstEventType type :
         { GST_EVENT_FLUSH_START, GST_EVENT_FLUSH_STOP, GST_EVENT_SEGMENT }) {
      event = gst_harness_pull_event(h);
      fail_unless_equals_int(GST_EVENT_TYPE(event), type);
      if (type != GST_EVENT_SEGMENT)
        gst_event_unref(event);
    }
    const GstSegment *got = nullptr;
    gst_event_parse_segment(event, &got);
    fail_unless(gst_segment_is_equal(got, &segment));
    gst_event_unref(event);
  }
  ASSERT_EVENTS(e.tactile, "");
}

CHECK_TEST(test_flush_before_the_first_map)
{
  Extractor e; // a segment not yet sent is replaced by the one after the flush
  fail_unless(gst_harness_push_event(e.video, gst_event_new_flush_start()));
  fail_unless(gst_harness_push_event(e.video, gst_event_new_flush_stop(TRUE)));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.start = segment.time = 7 * kFrame;
  fail_unless(gst_harness_push_event(e.video, gst_event_new_segment(&segment)));
  push(e, make_frame(7, 3, 3));
  ASSERT_EVENTS(e.tactile, "stream-start flush-start flush-stop caps:3x3@25/1 segment");
  GstPad *pad = gst_element_get_static_pad(e.video->element, "tactile");
  GstEvent *event = gst_pad_get_sticky_event(pad, GST_EVENT_SEGMENT, 0);
  const GstSegment *got = nullptr;
  gst_event_parse_segment(event, &got);
  fail_unless_equals_uint64(got->start, 7 * kFrame);
  gst_event_unref(event);
  gst_object_unref(pad);
}

CHECK_TEST(test_flush_without_a_segment_after_it)
{
  Extractor e;
  fail_unless(gst_harness_push_event(e.video, gst_event_new_flush_start()));
  fail_unless(gst_harness_push_event(e.video, gst_event_new_flush_stop(TRUE)));
  fail_unless(gst_harness_push_event(e.video, gst_event_new_eos()));
  ASSERT_EVENTS(e.tactile, "stream-start flush-start flush-stop caps:3x3@25/1 eos");
}

CHECK_TEST(test_other_events)
{
  Extractor e;
  push(e, make_frame(0, 3, 3));
  events(e.tactile);
  events(e.video);
  // Events about the picture do not reach the maps.
  gst_harness_push_event(
      e.video, gst_event_new_tag(gst_tag_list_new(GST_TAG_VIDEO_CODEC, "MPEG-1", nullptr)));
  gst_harness_push_event(e.video, gst_event_new_segment_done(GST_FORMAT_TIME, 0));
  gst_harness_push_event(e.video, gst_event_new_stream_group_done(1));
  ASSERT_EVENTS(e.video, "tag segment-done stream-group-done");
  ASSERT_EVENTS(e.tactile, "segment-done stream-group-done");
}

CHECK_TEST(test_upstream_events)
{
  Extractor e;
  push(e, make_frame(0, 3, 3));
  while (GstEvent *event = gst_harness_try_pull_upstream_event(e.video))
    gst_event_unref(event);
  const auto assert_upstream = [&](const gchar *expected) {
    GstEvent *event = gst_harness_try_pull_upstream_event(e.video);
    fail_unless_equals_string(event != nullptr ? GST_EVENT_TYPE_NAME(event) : "", expected);
    if (event != nullptr)
      gst_event_unref(event);
  };
  gst_harness_push_upstream_event(e.tactile,
                                  gst_event_new_qos(GST_QOS_TYPE_UNDERFLOW, 0.5, 1000, 0));
  assert_upstream("");
  // Whoever makes the maps is to ask for their grid again; the film is not negotiated again.
  gst_harness_push_upstream_event(e.tactile, gst_event_new_reconfigure());
  assert_upstream("custom-upstream");
  assert_upstream("");
  gst_harness_push_upstream_event(e.video, gst_event_new_qos(GST_QOS_TYPE_UNDERFLOW, 0.5, 1000, 0));
  assert_upstream("qos");
  gst_harness_push_upstream_event(e.tactile,
                                  gst_event_new_seek(1, GST_FORMAT_TIME, GST_SEEK_FLAG_FLUSH,
                                                     GST_SEEK_TYPE_SET, 0, GST_SEEK_TYPE_NONE, -1));
  assert_upstream("seek");
}

/// The grid of maps on frames is what their own branch prefers.
CHECK_TEST(test_grid_asked_for)
{
  Extractor e;
  gst_harness_set_sink_caps_str(e.tactile, "application/x-tactile-map,rows=[2,4],columns=7");
  g_autoptr(GstPad) sink = gst_pad_get_peer(e.video->srcpad);
  g_autoptr(GstQuery) query
      = gst_query_new_custom(GST_QUERY_CUSTOM, gst_structure_new_empty("tactile-grid"));
  fail_unless(gst_pad_query(sink, query));
  guint rows = 0;
  guint columns = 0;
  fail_unless(gst_structure_get(gst_query_get_structure(query), "rows", G_TYPE_UINT, &rows,
                                "columns", G_TYPE_UINT, &columns, nullptr));
  ck_assert_uint_eq(rows, 3);
  ck_assert_uint_eq(columns, 7);
}

CHECK_TEST(test_missing_times)
{
  Extractor e;
  GstBuffer *frame = make_frame(5, 3, 3);
  GST_BUFFER_DURATION(frame) = GST_CLOCK_TIME_NONE;
  push(e, frame);
  assert_map(gst_harness_pull(e.tactile), 5, 3, 3); // 1 / 25 s

  frame = make_frame(6, 3, 3);
  GST_BUFFER_PTS(frame) = GST_CLOCK_TIME_NONE;
  push(e, frame);
  GstBuffer *map = gst_harness_pull(e.tactile);
  fail_if(GST_BUFFER_PTS_IS_VALID(map));
  gst_buffer_unref(map);

  events(e.tactile);
  frame = make_frame(7);
  GST_BUFFER_PTS(frame) = GST_CLOCK_TIME_NONE;
  fail_unless_equals_int(push(e, frame), GST_FLOW_OK); // no gap without a time
  ASSERT_EVENTS(e.tactile, "");

  gst_harness_set_src_caps_str(e.video, "video/x-raw,format=GRAY8,width=8,height=8,framerate=0/1");
  frame = make_frame(8, 3, 3);
  GST_BUFFER_DURATION(frame) = GST_CLOCK_TIME_NONE;
  push(e, frame);
  map = gst_harness_pull(e.tactile);
  fail_unless_equals_uint64(GST_BUFFER_PTS(map), 8 * kFrame);
  fail_if(GST_BUFFER_DURATION_IS_VALID(map));
  gst_buffer_unref(map);
}

// The first map, and the first after a frame that is marked, whether or not that one has a map.
CHECK_TEST(test_discont)
{
  Extractor e;
  for (guint i = 0; i < 6; i++) {
    const bool has_map = i != 4;
    GstBuffer *frame = has_map ? make_frame(i, 3, 3) : make_frame(i);
    if (i == 2 || i == 4)
      GST_BUFFER_FLAG_SET(frame, GST_BUFFER_FLAG_DISCONT);
    push(e, frame);
    if (!has_map)
      continue;
    GstBuffer *map = gst_harness_pull(e.tactile);
    fail_unless_equals_int(GST_BUFFER_IS_DISCONT(map), i == 0 || i == 2 || i == 5);
    gst_buffer_unref(map);
  }
}

// Tactors take the maps of sound at once.
CHECK_TEST(test_sound)
{
  Extractor x;
  for (const bool sounds : { true, false }) {
    GstBuffer *in = make_frame(sounds ? 0 : 1, 2, 2);
    if (sounds)
      add_sound_meta(in, tactile::TactileMap(2, 2));
    fail_unless_equals_int(gst_harness_push(x.video, in), GST_FLOW_OK);
    GstBuffer *map = gst_harness_pull(x.tactile);
    ck_assert_int_eq(GST_BUFFER_FLAG_IS_SET(map, kSoundMap), sounds);
    gst_buffer_unref(map);
  }
}

CHECK_TEST(test_unlinked_tactile_pad)
{
  Extractor e(true, false);
  for (guint i = 0; i < 3; i++)
    fail_unless_equals_int(push(e, make_frame(i, i, i)), GST_FLOW_OK); // the first one has no map
  fail_unless(gst_harness_push_event(e.video, gst_event_new_eos()));
  fail_unless_equals_int(gst_harness_buffers_received(e.video), 3);
}

CHECK_TEST(test_unlinked_video_pad)
{
  Extractor e(false, true);
  for (guint i = 1; i < 4; i++)
    fail_unless_equals_int(push(e, make_frame(i, i, i)), GST_FLOW_OK);
  fail_unless_equals_int(gst_harness_buffers_received(e.tactile), 3);
  fail_unless(gst_harness_push_event(e.video, gst_event_new_eos()));
  ASSERT_EVENTS(e.tactile, "stream-start caps:1x1@25/1 segment caps:2x2@25/1 caps:3x3@25/1 eos");
}

CHECK_TEST(test_both_unlinked)
{
  Extractor e(false, false);
  fail_unless_equals_int(push(e, make_frame(0, 3, 3)), GST_FLOW_NOT_LINKED);
  fail_unless_equals_int(push(e, make_frame(1)), GST_FLOW_NOT_LINKED);
}

static GstFlowReturn
refuse(GstPad *pad, GstObject *parent, GstBuffer *buffer)
{
  (void)parent;
  gst_buffer_unref(buffer);
  return static_cast<GstFlowReturn>(GPOINTER_TO_INT(g_object_get_data(G_OBJECT(pad), "flow")));
}

CHECK_TEST(test_flow_of_either_branch)
{
  for (const bool of_video : { false, true })
    for (const auto &[branch, whole] :
         { std::pair{ GST_FLOW_EOS, GST_FLOW_OK }, { GST_FLOW_ERROR, GST_FLOW_ERROR } }) {
      Extractor e;
      GstPad *pad = (of_video ? e.video : e.tactile)->sinkpad;
      g_object_set_data(G_OBJECT(pad), "flow", GINT_TO_POINTER(branch));
      gst_pad_set_chain_function(pad, refuse);
      fail_unless_equals_int(push(e, make_frame(0, 3, 3)), whole);
    }
}

/// A branch is removed while it has a map: the film goes on.
CHECK_TEST(test_branch_taken_away_under_way)
{
  for (const bool of_video : { false, true }) {
    Extractor e;
    GstPad *pad = (of_video ? e.video : e.tactile)->sinkpad;
    gst_pad_set_chain_function(pad, [](GstPad *pad, GstObject *, GstBuffer *buffer) {
      gst_buffer_unref(buffer);
      GstPad *peer = gst_pad_get_peer(pad);
      gst_pad_unlink(peer, pad);
      gst_object_unref(peer);
      return GST_FLOW_FLUSHING; // the result of a call blocked in an element that is shut down
    });
    for (guint i = 0; i < 3; i++)
      fail_unless_equals_int(push(e, make_frame(i, 3, 3)), GST_FLOW_OK);
    fail_unless_equals_int(gst_harness_buffers_received(of_video ? e.tactile : e.video), 3);
  }
}

CHECK_TEST(test_caps_queries)
{
  Extractor e(true, true, nullptr);
  gst_harness_set_sink_caps_str(e.video, "video/x-raw,format={NV12,I420}; audio/x-raw");
  GstCaps *caps = gst_pad_peer_query_caps(e.video->srcpad, nullptr);
  GstCaps *expected = gst_caps_from_string("video/x-raw,format={NV12,I420}");
  fail_unless(gst_caps_is_equal(caps, expected), "%" GST_PTR_FORMAT, caps);
  gst_caps_unref(caps);
  GstCaps *other = gst_caps_from_string("video/x-raw,format=RGB,width=8,height=8,framerate=25/1");
  fail_if(gst_pad_peer_query_accept_caps(e.video->srcpad, other));
  gst_caps_unref(other);
  gst_caps_unref(expected);

  // Queried from downstream, the video pad's caps are upstream's.
  gst_harness_set_src_caps_str(e.video, "video/x-raw,format=I420,width=8,height=8,framerate=25/1");
  caps = gst_pad_peer_query_caps(e.video->sinkpad, nullptr);
  expected = gst_caps_from_string("video/x-raw,format=I420,width=8,height=8,framerate=25/1");
  fail_unless(gst_caps_is_equal(caps, expected), "%" GST_PTR_FORMAT, caps);
  gst_caps_unref(caps);
  gst_caps_unref(expected);
}

CHECK_TEST(test_allocation_and_latency)
{
  Extractor e;
  gst_harness_add_propose_allocation_meta(e.video, GST_VIDEO_META_API_TYPE, nullptr);
  GstCaps *caps = gst_caps_from_string(kVideoCaps);
  GstQuery *query = gst_query_new_allocation(caps, TRUE);
  fail_unless(gst_pad_peer_query(e.video->srcpad, query));
  fail_unless(gst_query_find_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr));
  gst_query_unref(query);
  gst_caps_unref(caps);

  gst_harness_set_upstream_latency(e.video, 70 * GST_MSECOND);
  for (GstHarness *h : { e.video, e.tactile }) {
    GstQuery *latency = gst_query_new_latency();
    fail_unless(gst_pad_peer_query(h->sinkpad, latency));
    GstClockTime min = 0;
    gst_query_parse_latency(latency, nullptr, &min, nullptr);
    fail_unless_equals_uint64(min, 70 * GST_MSECOND);
    gst_query_unref(latency);
  }
}

CHECK_TEST(test_any_memory)
{
  Extractor e(true, true, "video/x-raw(memory:DMABuf),format=NV12,width=8,height=8,framerate=25/1");
  fail_unless_equals_int(push(e, make_frame(0, 3, 3)), GST_FLOW_OK);
  assert_map(gst_harness_pull(e.tactile), 0, 3, 3);
}

/// Once a play: elements such as videoflip drop maps.
CHECK_TEST(test_frames_without_maps_are_told)
{
  Extractor e;
  const ElementBus messages(e.video->element);
  const auto told = [&] {
    int count = 0;
    while (GstMessage *message = gst_bus_pop_filtered(messages.bus, GST_MESSAGE_INFO)) {
      count += Said(message).text == "The video frames carry no tactile map.";
      gst_message_unref(message);
    }
    return count;
  };
  push(e, make_frame(0, 2, 2));
  fail_unless_equals_int(told(), 0);
  push(e, make_frame(1));
  push(e, make_frame(2));
  fail_unless_equals_int(told(), 1);
}

CHECK_TEST(test_restart)
{
  Extractor e;
  push(e, make_frame(0, 2, 2));
  assert_map(gst_harness_pull(e.tactile), 0, 2, 2);
  GstElement *element = e.video->element;
  fail_unless_equals_int(gst_element_set_state(element, GST_STATE_READY), GST_STATE_CHANGE_SUCCESS);
  fail_unless_equals_int(gst_element_set_state(element, GST_STATE_PLAYING),
                         GST_STATE_CHANGE_SUCCESS);
  events(e.tactile);
  gst_harness_set_src_caps_str(e.video, kVideoCaps);
  push(e, make_frame(0, 2, 2));
  ASSERT_EVENTS(e.tactile, "stream-start caps:2x2@25/1 segment");
}

/// A map of a track that begins within a frame comes at its own time, also through a copy.
CHECK_TEST(test_maps_within_a_frame)
{
  Extractor x;
  g_autoptr(GstBuffer) frame = make_frame(2, 1, 2);
  tactile::TactileMap map(1, 2);
  map.levels = { 0.5F, 0 };
  map.frequency = 120;
  const std::array<LaterMap, 2> later{ LaterMap{ std::chrono::milliseconds(10), map },
                                       LaterMap{ std::chrono::milliseconds(25),
                                                 tactile::TactileMap(1, 2) } };
  set_later_maps(frame, later);
  fail_unless_equals_int(gst_harness_push(x.video, gst_buffer_copy(frame)), GST_FLOW_OK);
  const std::array<GstClockTime, 4> times{ 80, 90, 105, 120 };
  for (std::size_t i = 0; i < 3; i++) {
    g_autoptr(GstBuffer) felt = gst_harness_pull(x.tactile);
    fail_unless_equals_uint64(GST_BUFFER_PTS(felt), times[i] * GST_MSECOND);
    fail_unless_equals_uint64(GST_BUFFER_DURATION(felt), (times[i + 1] - times[i]) * GST_MSECOND);
    fail_unless_equals_float(gst_buffer_get_tactile_frequency(felt), i == 1 ? 120 : 0);
    fail_unless_equals_int(GST_BUFFER_IS_DISCONT(felt), i == 0);
    gfloat level = -1;
    gst_buffer_extract(felt, 0, &level, sizeof level);
    fail_unless_equals_float(level, i == 1 ? 0.5F : i == 0 ? 0.25F : 0);
  }
  // A copy shares them.
  g_autoptr(GstBuffer) copy = gst_buffer_copy(frame);
  fail_unless(later_maps(copy) != nullptr && later_maps(copy) == later_maps(frame));
  // Not what is after the end of a frame that was cut.
  GST_BUFFER_DURATION(copy) = 20 * GST_MSECOND;
  fail_unless_equals_int(gst_harness_push(x.video, gst_buffer_ref(copy)), GST_FLOW_OK);
  for (int i = 0; i < 2; i++) {
    g_autoptr(GstBuffer) felt = gst_harness_pull(x.tactile);
    fail_unless_equals_uint64(GST_BUFFER_DURATION(felt), 10 * GST_MSECOND);
  }
  fail_unless(gst_harness_try_pull(x.tactile) == nullptr);
  // Not those of a map that was replaced.
  const std::array<gfloat, 2> other{ 1, 1 };
  gst_buffer_add_tactile_meta(frame, 1, 2, other.data(), 2);
  fail_unless_equals_int(gst_harness_push(x.video, gst_buffer_copy(frame)), GST_FLOW_OK);
  gst_buffer_unref(gst_harness_pull(x.tactile));
  fail_unless(gst_harness_try_pull(x.tactile) == nullptr);
}

CHECK_MAIN(tactileextractor)
