// SPDX-License-Identifier: LGPL-2.1-or-later
//
// saliencytactile over time: changes of properties, resets, rates, new streams, and its statistics.
#include "saliencytactile_rig.h"

#include "support/check_tests.h"

constexpr const char *kTiny = "video/x-raw,format=GRAY8,width=16,height=16,framerate=30/1";

/// Properties apply from the next frame on, including the grid.
CHECK_TEST(test_properties_while_playing)
{
  const SquareFilm film("I420", 0, 0);
  Analysis analysis;
  analysis.set_caps(film.caps);
  guint i = 0;
  for (GstBuffer *frame : film.frames) {
    const guint rows = 1 + i % 7;
    const guint columns = 1 + (i * 5) % 64;
    g_object_set(analysis.element, "rows", rows, "columns", columns, "threshold", i / 16.0,
                 "center-weight", i % 3 / 2.0, "temporal", i % 3 != 0, "floor", i % 5 - 1.0,
                 "attach-saliency", i % 2 == 0, "max-rate", i % 4 * 10.0, "profile", i % 2,
                 "n-threads", i % 5, "exact", i % 7 < 3, nullptr);
    g_autoptr(GstBuffer) out = analysis.pass(gst_buffer_ref(frame));
    const GstTactileMeta *meta = gst_buffer_get_tactile_meta(out);
    ck_assert_uint_eq(meta->rows, rows);
    ck_assert_uint_eq(meta->columns, columns);
    ck_assert_int_eq(gst_buffer_get_saliency_meta(out) != nullptr, i % 2 == 0);
    i++;
  }
}

/// Any number of threads gives the same maps, also if it changes within a stream: the history is
/// kept.
CHECK_TEST(test_threads)
{
  const SquareFilm film("NV12", 1, 2);
  const std::vector<gfloat> expected = Analysis("saliencytactile n-threads=1").play(film);
  ck_assert_uint_eq(strongest(expected), 5);

  Analysis again;
  guint threads;
  g_object_get(again.element, "n-threads", &threads, nullptr);
  ck_assert_uint_eq(threads, 0);
  again.set_caps(film.caps);
  for (GstBuffer *frame : film.frames) {
    g_object_set(again.element, "n-threads", ++threads, nullptr);
    const std::vector<gfloat> levels = again.felt(gst_buffer_ref(frame));
    if (frame == film.frames.back())
      fail_unless(levels == expected);
  }
}

/// A map whose maximum is below the floor is silent.
CHECK_TEST(test_floor_silences)
{
  for (const gfloat level : Analysis("saliencytactile floor=500").play(SquareFilm("I420", 1, 1)))
    fail_unless(level == 0);
}

/// No cue at the start, nor after a flush, a new segment, new caps or a discontinuity: a square
/// that is there at once is no event.
CHECK_TEST(test_no_burst_after_resets)
{
  const SquareFilm film("I420", 1, 1);
  GstBuffer *const empty = film.frames.front();
  GstBuffer *const square = film.frames.back();
  Analysis analysis;
  analysis.set_caps(film.caps);
  GstClockTime pts = 0;
  const auto felt = [&](GstBuffer *frame, bool discont) {
    GstBuffer *copy = gst_buffer_copy(frame);
    GST_BUFFER_PTS(copy) = pts;
    pts += GST_SECOND / 30;
    if (discont)
      GST_BUFFER_FLAG_SET(copy, GST_BUFFER_FLAG_DISCONT);
    return std::ranges::max(analysis.felt(copy)) > 0;
  };
  fail_if(felt(square, false));
  for (int i = 0; i < 5; i++)
    fail_if(felt(empty, i == 0));
  fail_unless(felt(square, false), "no cue for the event");

  fail_if(felt(empty, true));
  fail_if(felt(square, true));
  fail_if(felt(empty, true));
  analysis.push_segment();
  fail_if(felt(square, false));
  fail_if(felt(empty, true));
  analysis.flush();
  fail_if(felt(square, false));
  pts = 0; // back in time without an event
  fail_if(felt(empty, false));
}

/// The film with its time stamps swapped, 1 0 3 2 …, or in the order in which B-frames are decoded.
/// A square that appears is the event that it is in order.
CHECK_TEST(test_swapped_times)
{
  const SquareFilm film("I420", 0, 2);
  const auto play = [&](const std::vector<int> &order, std::vector<gfloat> &levels) {
    Analysis analysis;
    analysis.set_caps(film.caps);
    for (std::size_t i = 0; i < film.frames.size(); i++) {
      GstBuffer *frame = gst_buffer_copy(film.frames[i]);
      const std::size_t group = i / order.size() * order.size();
      GST_BUFFER_PTS(frame) = gst_util_uint64_scale(
          group + static_cast<guint64>(order[i % order.size()]), GST_SECOND, 30);
      levels = analysis.felt(frame);
    }
  };
  for (const std::vector<int> &order :
       { std::vector<int>{ 1, 0 }, { 0, 3, 1, 2 }, { 3, 1, 0, 2 } }) {
    std::vector<gfloat> levels;
    play(order, levels);
    fail_unless(std::ranges::max(levels) > 0, "no cue for the event");
    ck_assert_uint_eq(strongest(levels), 2);
  }
}

/// All frames have one time, as GStreamer 1.22 reads a GIF: one warning, and the analysis goes by
/// the frame rate.
CHECK_TEST(test_standing_times)
{
  const SquareFilm film("I420", 0, 2);
  Analysis analysis;
  analysis.set_caps(film.caps);
  std::vector<gfloat> levels;
  for (GstBuffer *frame : film.frames) {
    GstBuffer *copy = gst_buffer_copy(frame);
    GST_BUFFER_PTS(copy) = 0;
    levels = analysis.felt(copy);
  }
  fail_unless(std::ranges::max(levels) > 0, "no cue for the event");
  ck_assert_uint_eq(strongest(levels), 2);
  fail_unless(analysis.messages.has(GST_MESSAGE_WARNING));
  fail_if(analysis.messages.has(GST_MESSAGE_WARNING));
}

/// What a decoder made up for lost data is not felt, and the history goes on: the square that is
/// there in corrupted frames is an event once it is there in a whole one.
CHECK_TEST(test_corrupted_frames)
{
  const SquareFilm film("I420", 0, 2);
  Analysis analysis("saliencytactile skip-unchanged=false");
  analysis.set_caps(film.caps);
  for (std::size_t i = 0; i < film.frames.size(); i++) {
    GstBuffer *frame = gst_buffer_copy(film.frames[i]);
    const bool corrupted = i >= 11 && i < 14;
    if (corrupted)
      GST_BUFFER_FLAG_SET(frame, GST_BUFFER_FLAG_CORRUPTED);
    const std::vector<gfloat> levels = analysis.felt(frame);
    if (i < 14)
      fail_unless(std::ranges::max(levels) == 0);
    else
      fail_unless(std::ranges::max(levels) > 0 && strongest(levels) == 2);
  }
  ck_assert_uint_eq(stat_of(analysis.element, "frames"), film.frames.size());
  ck_assert_uint_eq(stat_of(analysis.element, "analyzed"), film.frames.size() - 3);
}

/// Played backwards, a square that appears is an event as well.
CHECK_TEST(test_reverse)
{
  const SquareFilm film("I420", 0, 2);
  Analysis analysis;
  analysis.set_caps(film.caps);
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.rate = -1;
  segment.stop = GST_SECOND;
  segment.position = GST_SECOND;
  fail_unless(gst_harness_push_event(analysis.h, gst_event_new_segment(&segment)));
  std::vector<gfloat> levels;
  for (std::size_t i = 0; i < film.frames.size(); i++) {
    GstBuffer *frame = gst_buffer_copy(film.frames[i]);
    GST_BUFFER_PTS(frame) = (film.frames.size() - 1 - i) * (GST_SECOND / 30);
    GST_BUFFER_FLAG_SET(frame, GST_BUFFER_FLAG_DISCONT); // like GstBaseSrc
    levels = analysis.felt(frame);
  }
  ck_assert_uint_eq(strongest(levels), 2);
  fail_unless(std::ranges::max(levels) > 0);
}

/// Frames beyond max-rate repeat the last map: with 10 analyses a second at 30 fps, two of three.
CHECK_TEST(test_max_rate)
{
  Analysis analysis("saliencytactile max-rate=10 skip-unchanged=false");
  analysis.play(SquareFilm("I420", 0, 0));
  ck_assert_uint_eq(stat_of(analysis.element, "frames"), 16);
  ck_assert_uint_eq(stat_of(analysis.element, "analyzed"), 6); // frames 0, 3, 6, 9, 12, 15
}

/// Frames that show nothing new are not analyzed, unless the user wants all to be, or something may
/// raise what is far below the floor.
CHECK_TEST(test_skip_unchanged)
{
  struct Case
  {
    const char *line;
    bool skips;
  };
  for (const Case &one : { Case{ "saliencytactile", true },
                           { "saliencytactile floor=2", true },
                           { "saliencytactile skip-unchanged=false", false },
                           { "saliencytactile profile=paper", false },
                           { "saliencytactile temporal=false", false },
                           { "saliencytactile floor=0", false },
                           { "saliencytactile roi-weights=face=3", false } }) {
    Analysis analysis(one.line, kTiny);
    for (guint i = 0; i < 60; i++) {
      GstBuffer *frame = flat_frame(256, 9);
      GST_BUFFER_PTS(frame) = gst_util_uint64_scale(i, GST_SECOND, 30);
      GST_BUFFER_DURATION(frame) = GST_SECOND / 30;
      analysis.felt(frame);
    }
    const guint64 unchanged = stat_of(analysis.element, "unchanged");
    fail_unless_equals_uint64(stat_of(analysis.element, "analyzed"), 60 - unchanged);
    fail_unless(one.skips ? unchanged >= 30 && unchanged < 60 : unchanged == 0, "%s: %u", one.line,
                static_cast<guint>(unchanged));
  }
}

/// max-rate is never exceeded: 25 of 30 frames a second.
CHECK_TEST(test_max_rate_is_not_exceeded)
{
  Analysis analysis("saliencytactile max-rate=25 skip-unchanged=false", kTiny);
  for (guint i = 0; i < 300; i++) {
    GstBuffer *frame = flat_frame(256, 9);
    GST_BUFFER_PTS(frame) = gst_util_uint64_scale(i, GST_SECOND, 30);
    GST_BUFFER_DURATION(frame) = GST_SECOND / 30;
    analysis.felt(frame);
  }
  const guint64 analyzed = stat_of(analysis.element, "analyzed");
  fail_unless(analyzed >= 249 && analyzed <= 251, "%u", static_cast<guint>(analyzed));
}

/// With keep-maps a frame's own map is kept and the frame is not analyzed. Otherwise the map is
/// replaced.
CHECK_TEST(test_keep_maps)
{
  for (const bool keep : { false, true }) {
    Analysis analysis("saliencytactile skip-unchanged=false", kTiny);
    g_object_set(analysis.element, "keep-maps", gboolean{ keep }, nullptr);
    for (guint i = 0; i < 4; i++) {
      GstBuffer *frame = flat_frame(256, 9);
      GST_BUFFER_PTS(frame) = gst_util_uint64_scale(i, GST_SECOND, 30);
      const gfloat own[] = { 0.5F, 0.25F };
      if (i % 2 == 1)
        gst_buffer_add_tactile_meta(frame, 1, 2, own, 2);
      const std::vector<gfloat> levels = analysis.felt(frame);
      fail_unless_equals_int(levels.size(), keep && i % 2 == 1 ? 2 : 9);
      fail_unless(levels[0] == (keep && i % 2 == 1 ? 0.5F : 0.0F));
    }
    fail_unless_equals_uint64(stat_of(analysis.element, "frames"), 4);
    fail_unless_equals_uint64(stat_of(analysis.element, "analyzed"), keep ? 2 : 4);
    fail_unless_equals_uint64(stat_of(analysis.element, "active"), keep ? 2 : 0);
  }
}

CHECK_TEST(test_caps_change_mid_stream)
{
  Analysis analysis;
  for (const char *format : { "I420", "RGB", "GRAY8", "I420" })
    for (const int width : { 64, 33 }) {
      g_autofree gchar *caps = g_strdup_printf(
          "video/x-raw,format=%s,width=%d,height=31,framerate=25/1", format, width);
      analysis.set_caps(caps);
      for (int i = 0; i < 3; i++) {
        for (const gfloat level : analysis.felt(flat_frame(frame_size(caps), 100)))
          fail_unless(level == 0);
      }
    }
}

CHECK_TEST(test_statistics_message_at_eos)
{
  Analysis analysis("saliencytactile", kTiny);
  for (int i = 0; i < 3; i++)
    analysis.felt(flat_frame(256, 9));
  fail_unless(gst_harness_push_event(analysis.h, gst_event_new_eos()));
  g_autoptr(GstMessage) message = gst_bus_pop_filtered(analysis.messages.bus, GST_MESSAGE_ELEMENT);
  fail_unless(message && gst_message_has_name(message, "saliencytactile-stats"));
  guint64 frames = 0;
  gst_structure_get_uint64(gst_message_get_structure(message), "frames", &frames);
  ck_assert_uint_eq(frames, 3);
}

CHECK_MAIN(saliencytactile_stream)
