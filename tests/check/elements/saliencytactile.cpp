// SPDX-License-Identifier: LGPL-2.1-or-later
//
// saliencytactile as an element: what passes through it stays as it is, every format is seen as the
// same film, and every stream it may meet gets a map. What the map says is tested in libs/analyzer
// and libs/tactile_mapping.
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/tactile/tactile.h>
#include <gst/video/video.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr int kBall = 24; // side of the square "ball": fits into a cell of the cropped picture, too

/// A grey RGB frame with a reddish square, weak enough not to saturate the levels, at (x, y), or none if x < 0.
GstBuffer *
rgb_frame(const GstVideoInfo &info, int x, int y)
{
  GstBuffer *buffer = gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&info), nullptr);
  GstVideoFrame frame;
  fail_unless(gst_video_frame_map(&frame, &info, buffer, GST_MAP_WRITE));
  for (int row = 0; row < GST_VIDEO_INFO_HEIGHT(&info); row++) {
    guint8 *line = static_cast<guint8 *>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0))
                   + row * GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0);
    for (int column = 0; column < GST_VIDEO_INFO_WIDTH(&info); column++) {
      const bool inside
          = x >= 0 && column >= x && column < x + kBall && row >= y && row < y + kBall;
      line[3 * column] = inside ? 130 : 110;
      line[3 * column + 1] = inside ? 96 : 110;
      line[3 * column + 2] = inside ? 96 : 110;
    }
  }
  gst_video_frame_unmap(&frame);
  return buffer;
}

/// The film of the tests in any format, by videoconvert: 12 still frames, then a square appears in
/// the cell (row, column) of 3 × 3.
std::vector<GstBuffer *>
film(const char *format, int row, int column, GstCaps **caps_out, int width = kWidth,
     int height = kHeight)
{
  GstVideoInfo info;
  gst_video_info_set_format(&info, GST_VIDEO_FORMAT_RGB, static_cast<guint>(width),
                            static_cast<guint>(height));
  info.fps_n = 30;
  info.fps_d = 1;
  GstCaps *from = gst_video_info_to_caps(&info);
  g_autofree gchar *line
      = g_strdup_printf("videoconvert ! capsfilter caps=video/x-raw,format=%s", format);
  GstHarness *h = gst_harness_new_parse(line);
  gst_harness_set_src_caps(h, from);
  std::vector<GstBuffer *> frames;
  for (int i = 0; i < 16; i++) {
    GstBuffer *frame = i < 12 ? rgb_frame(info, -1, 0)
                              : rgb_frame(info, (2 * column + 1) * width / 6 - kBall / 2,
                                          (2 * row + 1) * height / 6 - kBall / 2);
    GST_BUFFER_PTS(frame) = gst_util_uint64_scale(static_cast<guint64>(i), GST_SECOND, 30);
    GST_BUFFER_DURATION(frame) = GST_SECOND / 30;
    fail_unless_equals_int(gst_harness_push(h, frame), GST_FLOW_OK);
    frames.push_back(gst_harness_pull(h));
  }
  GstPad *pad = gst_element_get_static_pad(h->element, "src");
  *caps_out = gst_pad_get_current_caps(GST_PAD_PEER(h->sinkpad));
  gst_object_unref(pad);
  gst_harness_teardown(h);
  return frames;
}

std::vector<gfloat>
levels_of(GstBuffer *buffer)
{
  const GstTactileMeta *meta = gst_buffer_get_tactile_meta(buffer);
  fail_unless(meta != nullptr, "no GstTactileMeta");
  return { meta->levels, meta->levels + meta->rows * meta->columns };
}

/// Plays a film through an element and returns the levels of its last frame.
std::vector<gfloat>
play(GstHarness *h, GstCaps *caps, const std::vector<GstBuffer *> &frames)
{
  gst_harness_set_src_caps(h, gst_caps_ref(caps));
  std::vector<gfloat> levels;
  for (GstBuffer *frame : frames) {
    fail_unless_equals_int(gst_harness_push(h, gst_buffer_ref(frame)), GST_FLOW_OK);
    GstBuffer *out = gst_harness_pull(h);
    levels = levels_of(out);
    gst_buffer_unref(out);
  }
  return levels;
}

void
release(std::vector<GstBuffer *> &frames, GstCaps *caps)
{
  for (GstBuffer *frame : frames)
    gst_buffer_unref(frame);
  frames.clear();
  gst_caps_unref(caps);
}

std::size_t
strongest(const std::vector<gfloat> &levels)
{
  return static_cast<std::size_t>(std::ranges::max_element(levels) - levels.begin());
}

const char *const kFormats[]
    = { "I420", "YV12", "NV12", "NV21", "YUY2",      "UYVY",      "Y42B",
        "Y444", "RGB",  "BGR",  "RGBx", "BGRx",      "xRGB",      "xBGR",
        "RGBA", "BGRA", "ARGB", "ABGR", "I420_10LE", "P010_10LE", "GRAY8" };

} // namespace

/// Every format is the same film: the square's cell is strongest, and the levels are those of RGB.
GST_START_TEST(test_formats)
{
  const char *format = kFormats[__i__];
  GstCaps *caps;
  std::vector<GstBuffer *> frames = film("RGB", 2, 0, &caps);
  GstHarness *h = gst_harness_new("saliencytactile");
  const std::vector<gfloat> reference = play(h, caps, frames);
  gst_harness_teardown(h);
  release(frames, caps);
  ck_assert_uint_eq(reference.size(), 9);
  ck_assert_uint_eq(strongest(reference), 6);
  fail_unless(reference[6] > 0.2f);

  frames = film(format, 2, 0, &caps);
  h = gst_harness_new("saliencytactile");
  g_object_set(h->element, "floor", 0.0, nullptr); // in grey the square is a faint one
  const std::vector<gfloat> levels = play(h, caps, frames);
  gst_harness_teardown(h);
  release(frames, caps);
  ck_assert_uint_eq(levels.size(), 9);
  ck_assert_uint_eq(strongest(levels), 6);
  // Grey has lost the colour, chroma subsampling a little of it.
  const float tolerance = g_str_equal(format, "GRAY8") ? 1.0f : 0.06f;
  for (std::size_t i = 0; i < 9; i++)
    fail_unless(std::abs(levels[i] - reference[i]) <= tolerance, "%s: cell %u is %g, in RGB %g",
                format, static_cast<guint>(i), levels[i], reference[i]);
}
GST_END_TEST;

/// Each cell of the grid is found, rows from the top, columns from the left, in both profiles.
GST_START_TEST(test_cells)
{
  for (const char *profile : { "tuned", "paper" })
    for (int row = 0; row < 3; row++)
      for (int column = 0; column < 3; column++) {
        GstCaps *caps;
        std::vector<GstBuffer *> frames = film("I420", row, column, &caps);
        GstHarness *h = gst_harness_new("saliencytactile");
        gst_util_set_object_arg(G_OBJECT(h->element), "profile", profile);
        const std::vector<gfloat> levels = play(h, caps, frames);
        fail_unless(strongest(levels) == static_cast<std::size_t>(3 * row + column),
                    "%s: row %d, column %d", profile, row, column);
        gst_harness_teardown(h);
        release(frames, caps);
      }
}
GST_END_TEST;

/// The same GstMemory goes out as came in, metas and flags of upstream stay, and a buffer that
/// others hold is not written to.
GST_START_TEST(test_memory_and_metas_stay)
{
  GstHarness *h = gst_harness_new("saliencytactile");
  gst_harness_set_src_caps_str(h, "video/x-raw,format=I420,width=64,height=48,framerate=30/1");
  GstBuffer *in = gst_harness_create_buffer(h, 64 * 48 * 3 / 2);
  gst_buffer_memset(in, 0, 77, gst_buffer_get_size(in));
  GST_BUFFER_PTS(in) = 123;
  gst_buffer_add_video_region_of_interest_meta(in, "face", 1, 2, 3, 4);
  GST_BUFFER_FLAG_SET(in, GST_BUFFER_FLAG_MARKER);
  GstMemory *memory = gst_buffer_peek_memory(in, 0);
  GstBuffer *held = gst_buffer_ref(in);

  fail_unless_equals_int(gst_harness_push(h, in), GST_FLOW_OK);
  GstBuffer *out = gst_harness_pull(h);
  fail_unless(gst_buffer_n_memory(out) == 1);
  fail_unless(gst_buffer_peek_memory(out, 0) == memory);
  fail_unless(gst_buffer_get_video_region_of_interest_meta_id(out, 0) != nullptr
              || gst_buffer_get_meta(out, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE) != nullptr);
  fail_unless(GST_BUFFER_FLAG_IS_SET(out, GST_BUFFER_FLAG_MARKER));
  ck_assert_uint_eq(GST_BUFFER_PTS(out), 123);
  fail_unless(gst_buffer_get_tactile_meta(out) != nullptr);
  fail_unless(gst_buffer_get_tactile_meta(held) == nullptr);
  GstMapInfo map;
  gst_buffer_map(held, &map, GST_MAP_READ);
  fail_unless(std::all_of(map.data, map.data + map.size, [](guint8 v) { return v == 77; }));
  gst_buffer_unmap(held, &map);
  gst_buffer_unref(held);
  gst_buffer_unref(out);

  // A buffer of our own alone is passed on as it is.
  in = gst_harness_create_buffer(h, 64 * 48 * 3 / 2);
  gst_buffer_memset(in, 0, 77, gst_buffer_get_size(in));
  GstBuffer *const same = in;
  fail_unless_equals_int(gst_harness_push(h, in), GST_FLOW_OK);
  out = gst_harness_pull(h);
  fail_unless(out == same);
  gst_buffer_unref(out);
  gst_harness_teardown(h);
}
GST_END_TEST;

/// Downstream's answer to ALLOCATION reaches upstream unchanged: its pools and metas are upstream's
/// business.
GST_START_TEST(test_allocation_passes)
{
  GstHarness *h = gst_harness_new("saliencytactile");
  gst_harness_add_propose_allocation_meta(h, GST_VIDEO_META_API_TYPE, nullptr);
  gst_harness_add_propose_allocation_meta(h, GST_VIDEO_CROP_META_API_TYPE, nullptr);
  gst_harness_set_src_caps_str(h, "video/x-raw,format=I420,width=64,height=48,framerate=30/1");
  GstBuffer *frame = gst_harness_create_buffer(h, 64 * 48 * 3 / 2);
  gst_buffer_memset(frame, 0, 0, gst_buffer_get_size(frame));
  fail_unless_equals_int(gst_harness_push(h, frame), GST_FLOW_OK);
  GstCaps *caps = gst_caps_from_string("video/x-raw,format=I420,width=64,height=48,framerate=30/1");
  GstQuery *query = gst_query_new_allocation(caps, FALSE);
  fail_unless(gst_pad_peer_query(h->srcpad, query));
  fail_unless(gst_query_find_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr));
  fail_unless(gst_query_find_allocation_meta(query, GST_VIDEO_CROP_META_API_TYPE, nullptr));
  gst_query_unref(query);
  gst_caps_unref(caps);
  gst_harness_teardown(h);
}
GST_END_TEST;

/// Any size from 1 × 1 up, odd ones too, any grid, any rate, with and without times.
GST_START_TEST(test_sizes_and_streams)
{
  const int sizes[][2]
      = { { 1, 1 }, { 1, 7 }, { 7, 1 }, { 2, 2 }, { 3, 3 }, { 17, 33 }, { 101, 75 }, { 640, 2 } };
  const char *const rates[] = { "30/1", "0/1", "24000/1001", "1/1000", "2147483647/1" };
  for (const auto &[width, height] : sizes)
    for (const char *format : { "I420", "NV12", "YUY2", "RGB", "GRAY8", "P010_10LE" })
      for (const char *profile : { "tuned", "paper" }) {
        GstHarness *h = gst_harness_new("saliencytactile");
        gst_util_set_object_arg(G_OBJECT(h->element), "profile", profile);
        g_object_set(h->element, "rows", 5u, "columns", 64u, "attach-saliency", TRUE, nullptr);
        const char *rate = rates[static_cast<std::size_t>(width + height) % G_N_ELEMENTS(rates)];
        g_autofree gchar *caps = g_strdup_printf(
            "video/x-raw,format=%s,width=%d,height=%d,framerate=%s", format, width, height, rate);
        gst_harness_set_src_caps_str(h, caps);
        GstVideoInfo info;
        GstCaps *parsed = gst_caps_from_string(caps);
        gst_video_info_from_caps(&info, parsed);
        gst_caps_unref(parsed);
        for (guint i = 0; i < 4; i++) {
          GstBuffer *frame = gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&info), nullptr);
          gst_buffer_memset(frame, 0, static_cast<guint8>(i * 60), gst_buffer_get_size(frame));
          GST_BUFFER_PTS(frame) = i % 2 ? i * GST_SECOND : GST_CLOCK_TIME_NONE;
          fail_unless_equals_int(gst_harness_push(h, frame), GST_FLOW_OK);
          GstBuffer *out = gst_harness_pull(h);
          const std::vector<gfloat> levels = levels_of(out);
          ck_assert_uint_eq(levels.size(), 320);
          fail_unless(std::ranges::all_of(levels, [](gfloat v) { return v >= 0 && v <= 1; }));
          fail_unless(gst_buffer_get_saliency_meta(out) != nullptr);
          gst_buffer_unref(out);
        }
        gst_harness_teardown(h);
      }
}
GST_END_TEST;

/// Only what the crop meta shows is felt: a square in the picture's bottom left corner is in the
/// middle of its crop.
GST_START_TEST(test_crop_meta)
{
  GstCaps *caps;
  std::vector<GstBuffer *> frames = film("I420", 2, 0, &caps);
  for (GstBuffer *&frame : frames) {
    frame = gst_buffer_make_writable(frame);
    GstVideoCropMeta *crop = gst_buffer_add_video_crop_meta(frame);
    crop->x = 0;
    crop->y = 160;
    crop->width = 106;
    crop->height = 80;
  }
  GstHarness *h = gst_harness_new("saliencytactile");
  ck_assert_uint_eq(strongest(play(h, caps, frames)), 4);
  gst_harness_teardown(h);
  // A crop outside the picture is cut to it.
  for (GstBuffer *&frame : frames) {
    GstVideoCropMeta *crop = gst_buffer_get_video_crop_meta(frame);
    crop->x = 4000000000u;
    crop->width = 4000000000u;
  }
  h = gst_harness_new("saliencytactile");
  play(h, caps, frames);
  gst_harness_teardown(h);
  release(frames, caps);
}
GST_END_TEST;

GST_START_TEST(test_interlaced)
{
  GstCaps *caps;
  std::vector<GstBuffer *> frames = film("I420", 1, 2, &caps);
  caps = gst_caps_make_writable(caps);
  gst_caps_set_simple(caps, "interlace-mode", G_TYPE_STRING, "interleaved", nullptr);
  GstHarness *h = gst_harness_new("saliencytactile");
  ck_assert_uint_eq(strongest(play(h, caps, frames)), 5);
  gst_harness_teardown(h);
  release(frames, caps);
}
GST_END_TEST;

/// A grid changed while playing holds from the next frame on; the other properties too.
GST_START_TEST(test_properties_while_playing)
{
  GstCaps *caps;
  std::vector<GstBuffer *> frames = film("I420", 0, 0, &caps);
  GstHarness *h = gst_harness_new("saliencytactile");
  gst_harness_set_src_caps(h, gst_caps_ref(caps));
  guint i = 0;
  for (GstBuffer *frame : frames) {
    const guint rows = 1 + i % 7;
    const guint columns = 1 + (i * 5) % 64;
    g_object_set(h->element, "rows", rows, "columns", columns, "threshold", i / 16.0, "temporal",
                 i % 3 != 0, "floor", i % 5 - 1.0, "attach-saliency", i % 2 == 0, "max-rate",
                 i % 4 * 10.0, "profile", i % 2, "n-threads", i % 5, nullptr);
    fail_unless_equals_int(gst_harness_push(h, gst_buffer_ref(frame)), GST_FLOW_OK);
    GstBuffer *out = gst_harness_pull(h);
    const GstTactileMeta *meta = gst_buffer_get_tactile_meta(out);
    ck_assert_uint_eq(meta->rows, rows);
    ck_assert_uint_eq(meta->columns, columns);
    ck_assert_int_eq(gst_buffer_get_saliency_meta(out) != nullptr, i % 2 == 0);
    gst_buffer_unref(out);
    i++;
  }
  gst_harness_teardown(h);
  release(frames, caps);
}
GST_END_TEST;

/// Any number of threads feels the same, also when it changes while playing: the history goes on.
GST_START_TEST(test_threads)
{
  GstCaps *caps;
  std::vector<GstBuffer *> frames = film("NV12", 1, 2, &caps);
  GstHarness *h = gst_harness_new("saliencytactile");
  g_object_set(h->element, "n-threads", 1, nullptr);
  const std::vector<gfloat> expected = play(h, caps, frames);
  gst_harness_teardown(h);
  ck_assert_uint_eq(strongest(expected), 5);

  h = gst_harness_new("saliencytactile");
  guint threads;
  g_object_get(h->element, "n-threads", &threads, nullptr);
  ck_assert_uint_eq(threads, 0);
  gst_harness_set_src_caps(h, gst_caps_ref(caps));
  for (GstBuffer *frame : frames) {
    g_object_set(h->element, "n-threads", ++threads, nullptr);
    fail_unless_equals_int(gst_harness_push(h, gst_buffer_ref(frame)), GST_FLOW_OK);
    GstBuffer *out = gst_harness_pull(h);
    if (frame == frames.back())
      fail_unless(levels_of(out) == expected);
    gst_buffer_unref(out);
  }
  gst_harness_teardown(h);
  release(frames, caps);
}
GST_END_TEST;

/// The floor silences whatever is weaker, whatever the frame's maximum.
GST_START_TEST(test_floor_silences)
{
  GstCaps *caps;
  std::vector<GstBuffer *> frames = film("I420", 1, 1, &caps);
  GstHarness *h = gst_harness_new("saliencytactile");
  g_object_set(h->element, "floor", 500.0, nullptr);
  for (const gfloat level : play(h, caps, frames))
    fail_unless(level == 0);
  gst_harness_teardown(h);
  release(frames, caps);
}
GST_END_TEST;

/// Nothing bursts at the start, after a flush, a new segment, new caps or a discontinuity: the
/// square that is there at once is not an event.
GST_START_TEST(test_no_burst_after_resets)
{
  GstCaps *caps;
  std::vector<GstBuffer *> frames = film("I420", 1, 1, &caps);
  GstBuffer *const empty = frames.front();
  GstBuffer *const square = frames.back();
  GstHarness *h = gst_harness_new("saliencytactile");
  gst_harness_set_src_caps(h, gst_caps_ref(caps));
  GstClockTime pts = 0;
  const auto felt = [&](GstBuffer *frame, bool discont) {
    GstBuffer *copy = gst_buffer_copy(frame);
    GST_BUFFER_PTS(copy) = pts;
    pts += GST_SECOND / 30;
    if (discont)
      GST_BUFFER_FLAG_SET(copy, GST_BUFFER_FLAG_DISCONT);
    fail_unless_equals_int(gst_harness_push(h, copy), GST_FLOW_OK);
    GstBuffer *out = gst_harness_pull(h);
    const std::vector<gfloat> levels = levels_of(out);
    gst_buffer_unref(out);
    return *std::ranges::max_element(levels) > 0;
  };
  fail_if(felt(square, false));
  for (int i = 0; i < 5; i++)
    fail_if(felt(empty, i == 0));
  fail_unless(felt(square, false), "the event itself must be felt");

  fail_if(felt(empty, true));
  fail_if(felt(square, true));
  fail_if(felt(empty, true));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  fail_unless(gst_harness_push_event(h, gst_event_new_segment(&segment)));
  fail_if(felt(square, false));
  fail_if(felt(empty, true));
  fail_unless(gst_harness_push_event(h, gst_event_new_flush_start()));
  fail_unless(gst_harness_push_event(h, gst_event_new_flush_stop(TRUE)));
  fail_unless(gst_harness_push_event(h, gst_event_new_segment(&segment)));
  fail_if(felt(square, false));
  pts = 0; // back in time without a word
  fail_if(felt(empty, false));
  gst_harness_teardown(h);
  release(frames, caps);
}
GST_END_TEST;

/// Backwards, what appears is felt as forwards.
GST_START_TEST(test_reverse)
{
  GstCaps *caps;
  std::vector<GstBuffer *> frames = film("I420", 0, 2, &caps);
  GstHarness *h = gst_harness_new("saliencytactile");
  gst_harness_set_src_caps(h, gst_caps_ref(caps));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.rate = -1;
  segment.stop = GST_SECOND;
  segment.position = GST_SECOND;
  fail_unless(gst_harness_push_event(h, gst_event_new_segment(&segment)));
  std::vector<gfloat> levels;
  for (std::size_t i = 0; i < frames.size(); i++) {
    GstBuffer *frame = gst_buffer_copy(frames[i]);
    GST_BUFFER_PTS(frame) = (frames.size() - 1 - i) * (GST_SECOND / 30);
    GST_BUFFER_FLAG_SET(frame, GST_BUFFER_FLAG_DISCONT); // as GstBaseSrc does
    fail_unless_equals_int(gst_harness_push(h, frame), GST_FLOW_OK);
    GstBuffer *out = gst_harness_pull(h);
    levels = levels_of(out);
    gst_buffer_unref(out);
  }
  ck_assert_uint_eq(strongest(levels), 2);
  fail_unless(std::ranges::max(levels) > 0);
  gst_harness_teardown(h);
  release(frames, caps);
}
GST_END_TEST;

/// Frames beyond max-rate repeat the map: at 30 frames/s and 10 analyses, two of three.
GST_START_TEST(test_max_rate)
{
  GstCaps *caps;
  std::vector<GstBuffer *> frames = film("I420", 0, 0, &caps);
  GstHarness *h = gst_harness_new("saliencytactile");
  g_object_set(h->element, "max-rate", 10.0, nullptr);
  play(h, caps, frames);
  GstStructure *stats = nullptr;
  g_object_get(h->element, "stats", &stats, nullptr);
  guint64 passed = 0;
  guint64 analysed = 0;
  gst_structure_get_uint64(stats, "frames", &passed);
  gst_structure_get_uint64(stats, "analysed", &analysed);
  ck_assert_uint_eq(passed, 16);
  ck_assert_uint_eq(analysed, 6); // frames 0, 3, 6, 9, 12, 15
  gst_structure_free(stats);
  gst_harness_teardown(h);
  release(frames, caps);
}
GST_END_TEST;

/// No rate is exceeded, whatever the film's: 25 of 30 frames a second.
GST_START_TEST(test_max_rate_is_not_exceeded)
{
  GstHarness *h = gst_harness_new("saliencytactile");
  g_object_set(h->element, "max-rate", 25.0, nullptr);
  gst_harness_set_src_caps_str(h, "video/x-raw,format=GRAY8,width=16,height=16,framerate=30/1");
  for (guint i = 0; i < 300; i++) {
    GstBuffer *frame = gst_harness_create_buffer(h, 256);
    gst_buffer_memset(frame, 0, 9, 256);
    GST_BUFFER_PTS(frame) = gst_util_uint64_scale(i, GST_SECOND, 30);
    GST_BUFFER_DURATION(frame) = GST_SECOND / 30;
    fail_unless_equals_int(gst_harness_push(h, frame), GST_FLOW_OK);
    gst_buffer_unref(gst_harness_pull(h));
  }
  GstStructure *stats = nullptr;
  g_object_get(h->element, "stats", &stats, nullptr);
  guint64 analysed = 0;
  gst_structure_get_uint64(stats, "analysed", &analysed);
  fail_unless(analysed >= 249 && analysed <= 251, "%u", static_cast<guint>(analysed));
  gst_structure_free(stats);
  gst_harness_teardown(h);
}
GST_END_TEST;

/// With keep-maps a frame's own map stays, and is not paid for; without, it is replaced.
GST_START_TEST(test_keep_maps)
{
  for (const bool keep : { false, true }) {
    GstHarness *h = gst_harness_new("saliencytactile");
    g_object_set(h->element, "keep-maps", gboolean{ keep }, nullptr);
    gst_harness_set_src_caps_str(h, "video/x-raw,format=GRAY8,width=16,height=16,framerate=30/1");
    for (guint i = 0; i < 4; i++) {
      GstBuffer *frame = gst_harness_create_buffer(h, 256);
      gst_buffer_memset(frame, 0, 9, 256);
      GST_BUFFER_PTS(frame) = gst_util_uint64_scale(i, GST_SECOND, 30);
      const gfloat own[] = { 0.5F, 0.25F };
      if (i % 2 == 1)
        gst_buffer_add_tactile_meta(frame, 1, 2, own, 2);
      fail_unless_equals_int(gst_harness_push(h, frame), GST_FLOW_OK);
      GstBuffer *out = gst_harness_pull(h);
      fail_unless_equals_int(levels_of(out).size(), keep && i % 2 == 1 ? 2 : 9);
      fail_unless(levels_of(out)[0] == (keep && i % 2 == 1 ? 0.5F : 0.0F));
      gst_buffer_unref(out);
    }
    GstStructure *stats = nullptr;
    g_object_get(h->element, "stats", &stats, nullptr);
    guint64 frames = 0;
    guint64 analysed = 0;
    guint64 active = 0;
    gst_structure_get(stats, "frames", G_TYPE_UINT64, &frames, "analysed", G_TYPE_UINT64, &analysed,
                      "active", G_TYPE_UINT64, &active, nullptr);
    fail_unless_equals_uint64(frames, 4);
    fail_unless_equals_uint64(analysed, keep ? 2 : 4);
    fail_unless_equals_uint64(active, keep ? 2 : 0);
    gst_structure_free(stats);
    gst_harness_teardown(h);
  }
}
GST_END_TEST;

/// Fields that come one a buffer are half as high as the frame; a map of a side that no meta can hold is left out with one warning.
GST_START_TEST(test_alternate_fields_and_long_sides)
{
  GstHarness *h = gst_harness_new("saliencytactile");
  GstBus *bus = gst_bus_new();
  gst_element_set_bus(h->element, bus);
  gst_harness_set_src_caps_str(
      h, "video/x-raw(format:Interlaced),format=I420,width=64,height=96,framerate=25/"
         "1,interlace-mode=alternate");
  for (int i = 0; i < 4; i++) {
    // To the byte: whatever reads on is seen by a sanitizer.
    GstBuffer *field
        = gst_buffer_new_memdup(std::vector<guint8>(64 * 48 * 3 / 2, 80).data(), 64 * 48 * 3 / 2);
    GST_BUFFER_FLAG_SET(field, GST_VIDEO_BUFFER_FLAG_INTERLACED | GST_VIDEO_BUFFER_FLAG_ONEFIELD);
    fail_unless_equals_int(gst_harness_push(h, field), GST_FLOW_OK);
    GstBuffer *out = gst_harness_pull(h);
    ck_assert_uint_eq(levels_of(out).size(), 9);
    gst_buffer_unref(out);
  }
  fail_unless(gst_bus_pop_filtered(bus, GST_MESSAGE_WARNING) == nullptr);

  g_object_set(h->element, "attach-saliency", TRUE, "profile", 1, nullptr);
  gst_harness_set_src_caps_str(h, "video/x-raw,format=GRAY8,width=4,height=20000,framerate=25/1");
  for (int i = 0; i < 2; i++) {
    GstBuffer *frame = gst_harness_create_buffer(h, 80000);
    gst_buffer_memset(frame, 0, 9, 80000);
    fail_unless_equals_int(gst_harness_push(h, frame), GST_FLOW_OK);
    GstBuffer *out = gst_harness_pull(h);
    fail_unless(gst_buffer_get_saliency_meta(out) == nullptr);
    gst_buffer_unref(out);
  }
  GstMessage *warning = gst_bus_pop_filtered(bus, GST_MESSAGE_WARNING);
  fail_unless(warning != nullptr);
  gst_message_unref(warning);
  fail_unless(gst_bus_pop_filtered(bus, GST_MESSAGE_WARNING) == nullptr);
  gst_element_set_bus(h->element, nullptr);
  gst_object_unref(bus);
  gst_harness_teardown(h);
}
GST_END_TEST;

/// A buffer that is smaller than its caps say is passed on, felt as nothing, and said once.
GST_START_TEST(test_short_buffer)
{
  GstHarness *h = gst_harness_new("saliencytactile");
  GstBus *bus = gst_bus_new();
  gst_element_set_bus(h->element, bus);
  gst_harness_set_src_caps_str(h, "video/x-raw,format=I420,width=64,height=48,framerate=30/1");
  for (int i = 0; i < 3; i++) {
    fail_unless_equals_int(gst_harness_push(h, gst_harness_create_buffer(h, 100)), GST_FLOW_OK);
    GstBuffer *out = gst_harness_pull(h);
    for (const gfloat level : levels_of(out))
      fail_unless(level == 0);
    gst_buffer_unref(out);
  }
  GstMessage *message = gst_bus_pop_filtered(bus, GST_MESSAGE_WARNING);
  fail_unless(message != nullptr);
  gst_message_unref(message);
  fail_unless(gst_bus_pop_filtered(bus, GST_MESSAGE_WARNING) == nullptr);
  gst_element_set_bus(h->element, nullptr);
  gst_object_unref(bus);
  gst_harness_teardown(h);
}
GST_END_TEST;

GST_START_TEST(test_caps_change_mid_stream)
{
  GstHarness *h = gst_harness_new("saliencytactile");
  for (const char *format : { "I420", "RGB", "GRAY8", "I420" })
    for (const int width : { 64, 33 }) {
      g_autofree gchar *caps = g_strdup_printf(
          "video/x-raw,format=%s,width=%d,height=31,framerate=25/1", format, width);
      gst_harness_set_src_caps_str(h, caps);
      GstVideoInfo info;
      GstCaps *parsed = gst_caps_from_string(caps);
      gst_video_info_from_caps(&info, parsed);
      gst_caps_unref(parsed);
      for (int i = 0; i < 3; i++) {
        GstBuffer *frame = gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&info), nullptr);
        gst_buffer_memset(frame, 0, 100, gst_buffer_get_size(frame));
        fail_unless_equals_int(gst_harness_push(h, frame), GST_FLOW_OK);
        GstBuffer *out = gst_harness_pull(h);
        for (const gfloat level : levels_of(out))
          fail_unless(level == 0);
        gst_buffer_unref(out);
      }
    }
  gst_harness_teardown(h);
}
GST_END_TEST;

GST_START_TEST(test_statistics_message_at_eos)
{
  GstHarness *h = gst_harness_new("saliencytactile");
  GstBus *bus = gst_bus_new();
  gst_element_set_bus(h->element, bus);
  gst_harness_set_src_caps_str(h, "video/x-raw,format=GRAY8,width=16,height=16,framerate=25/1");
  for (int i = 0; i < 3; i++) {
    GstBuffer *frame = gst_harness_create_buffer(h, 256);
    gst_buffer_memset(frame, 0, 9, 256);
    fail_unless_equals_int(gst_harness_push(h, frame), GST_FLOW_OK);
  }
  fail_unless(gst_harness_push_event(h, gst_event_new_eos()));
  GstMessage *message = gst_bus_pop_filtered(bus, GST_MESSAGE_ELEMENT);
  fail_unless(message && gst_message_has_name(message, "saliencytactile-stats"));
  guint64 frames = 0;
  gst_structure_get_uint64(gst_message_get_structure(message), "frames", &frames);
  ck_assert_uint_eq(frames, 3);
  gst_message_unref(message);
  gst_element_set_bus(h->element, nullptr);
  gst_object_unref(bus);
  gst_harness_teardown(h);
}
GST_END_TEST;

static Suite *
saliencytactile_suite(void)
{
  Suite *suite = suite_create("saliencytactile");
  TCase *cases = tcase_create("general");
  suite_add_tcase(suite, cases);
  tcase_add_loop_test(cases, test_formats, 0, G_N_ELEMENTS(kFormats));
  tcase_add_test(cases, test_cells);
  tcase_add_test(cases, test_memory_and_metas_stay);
  tcase_add_test(cases, test_allocation_passes);
  tcase_add_test(cases, test_sizes_and_streams);
  tcase_add_test(cases, test_crop_meta);
  tcase_add_test(cases, test_interlaced);
  tcase_add_test(cases, test_properties_while_playing);
  tcase_add_test(cases, test_threads);
  tcase_add_test(cases, test_floor_silences);
  tcase_add_test(cases, test_no_burst_after_resets);
  tcase_add_test(cases, test_reverse);
  tcase_add_test(cases, test_max_rate);
  tcase_add_test(cases, test_max_rate_is_not_exceeded);
  tcase_add_test(cases, test_keep_maps);
  tcase_add_test(cases, test_alternate_fields_and_long_sides);
  tcase_add_test(cases, test_short_buffer);
  tcase_add_test(cases, test_caps_change_mid_stream);
  tcase_add_test(cases, test_statistics_message_at_eos);
  return suite;
}

GST_CHECK_MAIN(saliencytactile);
