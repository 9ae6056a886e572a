// SPDX-License-Identifier: LGPL-2.1-or-later
//
// saliencytactile and single frames: frames pass unchanged, and all formats of a film give the same
// maps. saliencytactile_stream tests what happens over time, libs/analyzer and libs/tactile_mapping
// test the maps' values.
#include <cmath>

#include "saliencytactile_rig.h"

#include "support/check_tests.h"

namespace {

const char *const kFormats[]
    = { "I420", "YV12", "NV12", "NV21", "YUY2",      "UYVY",      "Y42B",
        "Y444", "RGB",  "BGR",  "RGBx", "BGRx",      "xRGB",      "xBGR",
        "RGBA", "BGRA", "ARGB", "ABGR", "I420_10LE", "P010_10LE", "GRAY8" };
constexpr const char *kSmall = "video/x-raw,format=I420,width=64,height=48,framerate=30/1";

} // namespace

/// All formats show the same film: the square's cell is the strongest, and levels are those of RGB.
CHECK_LOOP_TEST(test_formats, 0, G_N_ELEMENTS(kFormats))
{
  const char *format = kFormats[__i__];
  const std::vector<gfloat> reference = Analysis().play(SquareFilm("RGB", 2, 0));
  ck_assert_uint_eq(reference.size(), 9);
  ck_assert_uint_eq(strongest(reference), 6);
  fail_unless(reference[6] > 0.2f);

  Analysis analysis("saliencytactile floor=0"); // in gray the square is faint
  const std::vector<gfloat> levels = analysis.play(SquareFilm(format, 2, 0));
  ck_assert_uint_eq(levels.size(), 9);
  ck_assert_uint_eq(strongest(levels), 6);
  // Gray loses the color, and chroma subsampling a little of it.
  const float tolerance = g_str_equal(format, "GRAY8") ? 1.0f : 0.06f;
  for (std::size_t i = 0; i < 9; i++)
    fail_unless(std::abs(levels[i] - reference[i]) <= tolerance, "%s: cell %u is %g, in RGB %g",
                format, static_cast<guint>(i), levels[i], reference[i]);
}

/// A checkerboard of red and cyan averages to the code values of the surrounding gray, but not to
/// its color. Small frames are converted pixel by pixel anyway.
CHECK_TEST(test_exact)
{
  struct Case
  {
    int scale;
    bool exact;
    bool seen;
  };
  for (const auto &[scale, exact, seen] :
       { Case{ 1, false, true }, { 4, false, false }, { 4, true, true } }) {
    Analysis analysis;
    g_object_set(analysis.element, "temporal", FALSE, "exact", exact, nullptr);
    const int width = 320 * scale;
    const int height = 240 * scale;
    g_autofree char *caps = g_strdup_printf(
        "video/x-raw,format=RGBx,width=%d,height=%d,framerate=30/1", width, height);
    analysis.set_caps(caps);
    GstBuffer *frame = gst_buffer_new_allocate(nullptr, gsize{ 4 } * width * height, nullptr);
    gst_buffer_memset(frame, 0, 128, gst_buffer_get_size(frame));
    const guint32 colors[] = { 0xff0000ff, 0xffffff00 }; // x, B', G', R'
    for (int y = 100 * scale; y < 140 * scale; ++y)
      for (int x = 240 * scale; x < 290 * scale; ++x)
        gst_buffer_fill(frame, gsize{ 4 } * (y * width + x), &colors[(x + y) % 2], 4);
    g_autoptr(GstBuffer) out = analysis.pass(frame);
    const std::vector<gfloat> levels = levels_of(out);
    ck_assert_int_eq(*std::ranges::max_element(levels) > 0, seen);
    fail_unless(!seen || strongest(levels) == 5);
  }
}

/// Each cell is found in both profiles. Rows count from the top, columns from the left.
CHECK_TEST(test_cells)
{
  for (const char *profile : { "tuned", "paper" })
    for (int row = 0; row < 3; row++)
      for (int column = 0; column < 3; column++) {
        Analysis analysis;
        analysis.set("profile", profile);
        const std::vector<gfloat> levels = analysis.play(SquareFilm("I420", row, column));
        fail_unless(strongest(levels) == static_cast<std::size_t>(3 * row + column),
                    "%s: row %d, column %d", profile, row, column);
      }
}

/// The same GstMemory comes out. Metas and flags of upstream stay, and a buffer that others hold is
/// not written to.
CHECK_TEST(test_memory_and_metas_stay)
{
  Analysis analysis("saliencytactile", kSmall);
  GstBuffer *in = flat_frame(64 * 48 * 3 / 2, 77);
  GST_BUFFER_PTS(in) = 123;
  gst_buffer_add_video_region_of_interest_meta(in, "face", 1, 2, 3, 4);
  GST_BUFFER_FLAG_SET(in, GST_BUFFER_FLAG_MARKER);
  GstMemory *memory = gst_buffer_peek_memory(in, 0);
  GstBuffer *held = gst_buffer_ref(in);

  g_autoptr(GstBuffer) out = analysis.pass(in);
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

  // A buffer without other owners is passed on itself.
  in = flat_frame(64 * 48 * 3 / 2, 77);
  GstBuffer *const same = in;
  g_autoptr(GstBuffer) unchanged = analysis.pass(in);
  fail_unless(unchanged == same);
}

/// Downstream's answer to an ALLOCATION query reaches upstream unchanged.
CHECK_TEST(test_allocation_passes)
{
  Analysis analysis;
  gst_harness_add_propose_allocation_meta(analysis.h, GST_VIDEO_META_API_TYPE, nullptr);
  gst_harness_add_propose_allocation_meta(analysis.h, GST_VIDEO_CROP_META_API_TYPE, nullptr);
  analysis.set_caps("video/x-raw,format=I420,width=64,height=48,framerate=30/1");
  GstBuffer *frame = flat_frame(64 * 48 * 3 / 2, 0);
  fail_unless_equals_int(gst_harness_push(analysis.h, frame), GST_FLOW_OK);
  GstCaps *caps = gst_caps_from_string(kSmall);
  GstQuery *query = gst_query_new_allocation(caps, FALSE);
  fail_unless(gst_pad_peer_query(analysis.h->srcpad, query));
  fail_unless(gst_query_find_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr));
  fail_unless(gst_query_find_allocation_meta(query, GST_VIDEO_CROP_META_API_TYPE, nullptr));
  gst_query_unref(query);
  gst_caps_unref(caps);
}

/// Any size from 1 × 1 on, any grid and any rate, with and without timestamps.
CHECK_TEST(test_sizes_and_streams)
{
  const int sizes[][2]
      = { { 1, 1 }, { 1, 7 }, { 7, 1 }, { 2, 2 }, { 3, 3 }, { 17, 33 }, { 101, 75 }, { 640, 2 } };
  const char *const rates[] = { "30/1", "0/1", "24000/1001", "1/1000", "2147483647/1" };
  for (const auto &[width, height] : sizes)
    for (const char *format : { "I420", "NV12", "YUY2", "RGB", "GRAY8", "P010_10LE" })
      for (const char *profile : { "tuned", "paper" }) {
        Analysis analysis;
        analysis.set("profile", profile);
        g_object_set(analysis.element, "rows", 5u, "columns", 64u, "attach-saliency", TRUE,
                     nullptr);
        const char *rate = rates[static_cast<std::size_t>(width + height) % G_N_ELEMENTS(rates)];
        g_autofree gchar *caps = g_strdup_printf(
            "video/x-raw,format=%s,width=%d,height=%d,framerate=%s", format, width, height, rate);
        analysis.set_caps(caps);
        for (guint i = 0; i < 4; i++) {
          GstBuffer *frame = flat_frame(frame_size(caps), static_cast<guint8>(i * 60));
          GST_BUFFER_PTS(frame) = i % 2 ? i * GST_SECOND : GST_CLOCK_TIME_NONE;
          g_autoptr(GstBuffer) out = analysis.pass(frame);
          const std::vector<gfloat> levels = levels_of(out);
          ck_assert_uint_eq(levels.size(), 320);
          fail_unless(std::ranges::all_of(levels, [](gfloat v) { return v >= 0 && v <= 1; }));
          fail_unless(gst_buffer_get_saliency_meta(out) != nullptr);
        }
      }
}

/// Only the picture inside the crop meta counts: a square in the bottom left corner is in the
/// middle of its crop.
CHECK_TEST(test_crop_meta)
{
  SquareFilm film("I420", 2, 0);
  for (GstBuffer *&frame : film.frames) {
    frame = gst_buffer_make_writable(frame);
    GstVideoCropMeta *crop = gst_buffer_add_video_crop_meta(frame);
    crop->x = 0;
    crop->y = 160;
    crop->width = 106;
    crop->height = 80;
  }
  ck_assert_uint_eq(strongest(Analysis().play(film)), 4);
  // A crop that exceeds the picture is clipped to it.
  for (GstBuffer *&frame : film.frames) {
    GstVideoCropMeta *crop = gst_buffer_get_video_crop_meta(frame);
    crop->x = 4000000000u;
    crop->width = 4000000000u;
  }
  Analysis().play(film);
}

CHECK_TEST(test_interlaced)
{
  SquareFilm film("I420", 1, 2);
  film.caps = gst_caps_make_writable(film.caps);
  gst_caps_set_simple(film.caps, "interlace-mode", G_TYPE_STRING, "interleaved", nullptr);
  ck_assert_uint_eq(strongest(Analysis().play(film)), 5);
}

/// Fields in separate buffers are half as high as the frame. A saliency map too long for its meta
/// is omitted, with one warning.
CHECK_TEST(test_alternate_fields_and_long_sides)
{
  Analysis analysis;
  analysis.set_caps("video/x-raw(format:Interlaced),format=I420,width=64,height=96,framerate=25/"
                    "1,interlace-mode=alternate");
  for (int i = 0; i < 4; i++) {
    // Of the exact size, so a sanitizer sees reads beyond it.
    GstBuffer *field
        = gst_buffer_new_memdup(std::vector<guint8>(64 * 48 * 3 / 2, 80).data(), 64 * 48 * 3 / 2);
    GST_BUFFER_FLAG_SET(field, GST_VIDEO_BUFFER_FLAG_INTERLACED | GST_VIDEO_BUFFER_FLAG_ONEFIELD);
    ck_assert_uint_eq(analysis.felt(field).size(), 9);
  }
  fail_if(analysis.messages.has(GST_MESSAGE_WARNING));

  g_object_set(analysis.element, "attach-saliency", TRUE, "profile", 1, nullptr);
  analysis.set_caps("video/x-raw,format=GRAY8,width=4,height=20000,framerate=25/1");
  for (int i = 0; i < 2; i++) {
    g_autoptr(GstBuffer) out = analysis.pass(flat_frame(80000, 9));
    fail_unless(gst_buffer_get_saliency_meta(out) == nullptr);
  }
  fail_unless(analysis.messages.has(GST_MESSAGE_WARNING));
  fail_if(analysis.messages.has(GST_MESSAGE_WARNING));
}

/// A buffer smaller than its caps require is passed on with a silent map and one warning.
CHECK_TEST(test_short_buffer)
{
  Analysis analysis("saliencytactile", kSmall);
  for (int i = 0; i < 3; i++) {
    for (const gfloat level : analysis.felt(flat_frame(100, 0)))
      fail_unless(level == 0);
  }
  fail_unless(analysis.messages.has(GST_MESSAGE_WARNING));
  fail_if(analysis.messages.has(GST_MESSAGE_WARNING));
}

namespace {

/// A gray frame without noise. A bright Gaussian spot of σ pixels is at (x, y), none if σ is 0.
GstBuffer *
spot_frame(int width, int height, double x, double y, double sigma)
{
  const auto size = static_cast<gsize>(width) * static_cast<gsize>(height);
  GstBuffer *frame = flat_frame(size, 80);
  if (sigma <= 0)
    return frame;
  GstMapInfo map;
  fail_unless(gst_buffer_map(frame, &map, GST_MAP_WRITE));
  for (int row = 0; row < height; row++)
    for (int column = 0; column < width; column++) {
      const double square = (column - x) * (column - x) + (row - y) * (row - y);
      map.data[row * width + column]
          = static_cast<guint8>(80 + std::lround(100 * std::exp(-square / (2 * sigma * sigma))));
    }
  gst_buffer_unmap(frame, &map);
  return frame;
}

struct Point
{
  double x;
  double y;
};

/// The centroid of a frame's saliency map in pixels of the picture, if the map is resized to the
/// picture.
Point
centroid_on_picture(GstBuffer *buffer, int width, int height)
{
  const GstSaliencyMeta *meta = gst_buffer_get_saliency_meta(buffer);
  fail_unless(meta != nullptr);
  double sum = 0;
  Point point{ 0, 0 };
  for (guint row = 0; row < meta->height; row++)
    for (guint column = 0; column < meta->width; column++) {
      const double value = meta->values[row * meta->width + column];
      sum += value;
      point.x += value * ((column + 0.5) * width / meta->width - 0.5);
      point.y += value * ((row + 0.5) * height / meta->height - 0.5);
    }
  fail_unless(sum > 0);
  return { point.x / sum, point.y / sum };
}

} // namespace

/// The saliency map, resized to the picture, is aligned with it: a spot's centroid is at the spot.
/// A single one is off by an amount that depends on its place between samples. The mean over one
/// sample's width is not.
CHECK_TEST(test_saliency_lies_on_the_picture)
{
  constexpr int kWide = 640;
  constexpr int kHigh = 360;
  constexpr int kPeriod = 32; // no map here has coarser samples
  Point error{ 0, 0 };
  double sample = 0;
  for (int phase = 0; phase < kPeriod; phase += 2) {
    Analysis analysis("saliencytactile attach-saliency=true",
                      "video/x-raw,format=GRAY8,width=640,height=360,framerate=30/1");
    const Point spot{ 300.0 + phase, 160.0 + phase };
    g_autoptr(GstBuffer) shown = nullptr;
    for (guint i = 0; i < 10; i++) {
      g_clear_pointer(&shown, gst_buffer_unref);
      GstBuffer *frame = spot_frame(kWide, kHigh, spot.x, spot.y, i < 9 ? 0 : 12);
      GST_BUFFER_PTS(frame) = i * GST_SECOND / 30;
      shown = analysis.pass(frame);
    }
    const Point found = centroid_on_picture(shown, kWide, kHigh);
    error.x += (found.x - spot.x) * 2 / kPeriod;
    error.y += (found.y - spot.y) * 2 / kPeriod;
    sample = static_cast<double>(kWide) / gst_buffer_get_saliency_meta(shown)->width;
  }
  fail_unless(sample <= kPeriod);
  fail_unless(std::abs(error.x) < 0.05 * sample && std::abs(error.y) < 0.05 * sample,
              "it lies %.3f, %.3f samples of %g pixels right and down", error.x / sample,
              error.y / sample, sample);
}

CHECK_MAIN(saliencytactile)
