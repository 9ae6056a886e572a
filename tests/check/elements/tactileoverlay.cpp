// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture.h"

#include "gst/fusion/sound_meta.h"

#include "support/contains.h"
#include "support/playing.h"
#include <gst/check/gstharness.h>
#include <gst/tactile/tactile.h>
#include <gst/video/video.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "support/check_tests.h"

namespace {

constexpr std::array kFormats{ "I420", "YV12", "NV12", "NV21", "YUY2",  "UYVY",      "Y42B",
                               "Y444", "RGB",  "BGR",  "RGBx", "BGRx",  "xRGB",      "xBGR",
                               "RGBA", "BGRA", "ARGB", "ABGR", "GRAY8", "I420_10LE", "P010_10LE" };

/// The grid's tint at a level: yellow to red.
Color
warm(double level)
{
  return { 255, 255 * 0.85 * (1 - level), 255 * 0.1 * (1 - level) };
}

constexpr Color kPicture{ 60, 90, 120 };
constexpr Color kWhite{ 255, 255, 255 };

std::string
caps_of(const std::string &format, int width, int height)
{
  return "video/x-raw,framerate=30/1,format=" + format + ",width=" + std::to_string(width)
         + ",height=" + std::to_string(height);
}

/// Rounding of the input, of what is blended in, of the result and of the weight.
double
tolerance_of(const std::string &format)
{
  if (format.find("10LE") != std::string::npos)
    return 1.8;
  return GST_VIDEO_FORMAT_INFO_IS_YUV(
             gst_video_format_get_info(gst_video_format_from_string(format.c_str())))
             ? 5.2
             : 1.5;
}

void
assert_color(const Picture &picture, int x, int y, const Color &expected, double tolerance)
{
  const Color got = picture.at(x, y);
  Color wanted = expected;
  if (picture.format == "GRAY8")
    wanted.red = wanted.green = wanted.blue
        = 0.299 * expected.red + 0.587 * expected.green + 0.114 * expected.blue;
  const double off = std::max({ std::abs(got.red - wanted.red), std::abs(got.green - wanted.green),
                                std::abs(got.blue - wanted.blue) });
  fail_unless(off <= tolerance, "%s: pixel %d, %d is %g %g %g rather than %g %g %g",
              picture.format.c_str(), x, y, got.red, got.green, got.blue, wanted.red, wanted.green,
              wanted.blue);
}

void
add_levels(GstBuffer *buffer, guint rows, guint columns, const std::vector<gfloat> &levels)
{
  fail_unless(gst_buffer_add_tactile_meta(buffer, rows, columns, levels.data(), levels.size())
              != nullptr);
}

void
add_saliency(GstBuffer *buffer, guint width, guint height, const std::vector<gfloat> &values,
             gfloat floor = 0)
{
  fail_unless(
      gst_buffer_add_saliency_meta(buffer, width, height, values.data(), values.size(), floor)
      != nullptr);
}

/// The overlay's output for a frame.
Picture
overlay(GstBuffer *frame, const std::string &format, int width, int height,
        const std::string &properties)
{
  GstHarness *h = gst_harness_new_parse(("tactileoverlay " + properties).c_str());
  gst_harness_set_src_caps_str(h, caps_of(format, width, height).c_str());
  GstBuffer *out = gst_harness_push_and_pull(h, frame);
  fail_unless(out != nullptr);
  Picture picture(out, format, width, height);
  gst_buffer_unref(out);
  gst_harness_teardown(h);
  return picture;
}

} // namespace

CHECK_TEST(test_grid_in_every_format)
{
  const std::vector<gfloat> levels{ 0.0F, 0.2F, 0.4F, 0.6F, 0.8F, 1.0F };
  constexpr int kCell = 48;
  constexpr int kWidth = 3 * kCell;
  constexpr int kHeight = 2 * kCell;
  for (const std::string format : kFormats)
    for (const double opacity : { 0.5, 1.0 }) {
      GstBuffer *frame = make_frame(format, kWidth, kHeight, kPicture);
      add_levels(frame, 2, 3, levels);
      const Picture out
          = overlay(frame, format, kWidth, kHeight, "opacity=" + std::to_string(opacity));
      for (int i = 0; i < 6; i++) {
        const double level = levels[static_cast<std::size_t>(i)];
        const auto expect = [&](int x, int y, const Color &color, double weight) {
          assert_color(out, i % 3 * kCell + x, i / 3 * kCell + y, mix(kPicture, color, weight),
                       tolerance_of(format));
        };
        expect(kCell / 2, kCell / 2, warm(level), opacity * level);
        expect(kCell - 4, 4, warm(level), opacity * level);
        expect(8, kCell - 4, warm(level), opacity * level);
        // The gauge: a twelfth of the cell's width, as high as the level between the borders.
        const double top = kCell - 1 - level * (kCell - 2);
        if (level > 0.1)
          expect(2, static_cast<int>(std::ceil(top)) + 2, warm(level), opacity);
        if (level < 0.9)
          expect(2, static_cast<int>(std::floor(top)) - 4, warm(level), opacity * level);
        // In small pictures borders are one pixel wide.
        expect(0, kCell / 2, kWhite, opacity);
        expect(kCell / 2, 0, kWhite, opacity);
      }
    }
}

// A cell to which sound added has a thick blue border, wherever the level is.
CHECK_TEST(test_border_of_sound)
{
  constexpr Color kBlue{ 0, 0.4 * 255, 255 };
  constexpr int kSide = 60;
  GstBuffer *frame = make_frame("RGB", 2 * kSide, kSide, kPicture);
  add_levels(frame, 1, 2, { 0.5F, 0.5F });
  tactile::TactileMap added(1, 2);
  added.at(0, 1) = 0.25F;
  add_sound_meta(frame, added);
  const Picture out = overlay(frame, "RGB", 2 * kSide, kSide, "opacity=1");
  assert_color(out, 0, kSide / 2, kWhite, 1.5);
  for (const int x : { 0, 2, kSide - 1 }) {
    assert_color(out, kSide + x, kSide / 2, kBlue, 1.5);
    assert_color(out, kSide + kSide / 2, std::min(x, kSide - 1), kBlue, 1.5);
  }
  assert_color(out, kSide / 2, 2, mix(kPicture, warm(0.5), 0.5), 1.5);
}

CHECK_TEST(test_borders)
{
  // All four sides of a cell have borders, as wide as 1/360 of the picture's shorter side.
  for (const auto &[width, height, line] : { std::tuple{ 90, 60, 1 }, { 1080, 1080, 3 } }) {
    GstBuffer *frame = make_frame("RGB", width, height, kPicture);
    add_levels(frame, 2, 3, std::vector<gfloat>(6, 0.0F));
    const Picture out = overlay(frame, "RGB", width, height, "opacity=0.25");
    for (int y = 0; y < height; y++)
      for (int x = 0; x < width; x++) {
        const int in_x = x % (width / 3);
        const int in_y = y % (height / 2);
        const bool border
            = in_x < line || in_x >= width / 3 - line || in_y < line || in_y >= height / 2 - line;
        assert_color(out, x, y, mix(kPicture, kWhite, border ? 0.25 : 0), 0.51);
      }
  }
}

CHECK_TEST(test_grid_covers_the_picture)
{
  // 7 columns in 50 pixels are too narrow for borders. Cell c has the pixels [⌊50 c / 7⌋, ⌊50 (c +
  // 1) / 7⌋), and likewise for rows.
  constexpr int kWidth = 50;
  constexpr int kHeight = 23;
  std::vector<gfloat> levels(7 * 5);
  for (std::size_t i = 0; i < levels.size(); i++)
    levels[i] = static_cast<gfloat>(i * 11 % 35 * 7) / 255;
  GstBuffer *frame = make_frame("RGB", kWidth, kHeight, kPicture);
  add_levels(frame, 5, 7, levels);
  const Picture out = overlay(frame, "RGB", kWidth, kHeight, "opacity=0.8");
  for (int r = 0; r < 5; r++)
    for (int c = 0; c < 7; c++)
      for (int y = r * kHeight / 5; y < (r + 1) * kHeight / 5; y++)
        for (int x = c * kWidth / 7; x < (c + 1) * kWidth / 7; x++) {
          const double level = levels[static_cast<std::size_t>(7 * r + c)];
          assert_color(out, x, y, mix(kPicture, warm(level), 0.8 * level), tolerance_of("RGB"));
        }
}

CHECK_TEST(test_heatmap_colors)
{
  // A field of a single value: blue, cyan, green, yellow, red.
  const std::array<std::pair<gfloat, Color>, 5> ramp{ {
      { 0.2F, { 0, 204, 255 } },
      { 0.4F, { 0, 255, 102 } },
      { 0.6F, { 102, 255, 0 } },
      { 0.8F, { 255, 204, 0 } },
      { 1.0F, { 255, 0, 0 } },
  } };
  for (const std::string format : kFormats)
    for (const auto &[level, color] : ramp) {
      GstBuffer *frame = make_frame(format, 16, 16, kPicture);
      add_levels(frame, 1, 1, { level });
      const Picture out = overlay(frame, format, 16, 16, "style=heatmap opacity=0.5");
      assert_color(out, 8, 8, mix(kPicture, color, 0.5 * std::min(1.0, 4.0 * level)),
                   tolerance_of(format));
    }
}

/// Bilinear between values at the centers of their cells, in double precision.
static double
interpolate(const std::vector<gfloat> &values, int columns, int rows, double x, double y)
{
  const double fx = std::clamp(x * columns - 0.5, 0.0, columns - 1.0);
  const double fy = std::clamp(y * rows - 0.5, 0.0, rows - 1.0);
  double sum = 0;
  for (int r = 0; r < rows; r++)
    for (int c = 0; c < columns; c++)
      sum += std::max(0.0, 1 - std::abs(fx - c)) * std::max(0.0, 1 - std::abs(fy - r))
             * values[static_cast<std::size_t>(r * columns + c)];
  return sum;
}

CHECK_TEST(test_saliency_is_interpolated)
{
  const std::vector<gfloat> values{ 0, 3, 9, 1, 5, 12, 2, 0, 7, 7, 4, 6 };
  for (const auto &[width, height] : { std::pair{ 61, 47 }, { 2, 2 }, { 1, 1 }, { 200, 100 } })
    for (const auto &[columns, rows] : { std::pair{ 4, 3 }, { 3, 4 }, { 12, 1 }, { 1, 12 } }) {
      GstBuffer *frame = make_frame("RGB", width, height, kPicture);
      add_saliency(frame, static_cast<guint>(columns), static_cast<guint>(rows), values);
      add_levels(frame, 1, 1, { 0.5F }); // saliency takes precedence
      const Picture out = overlay(frame, "RGB", width, height, "style=saliency opacity=0.1");
      for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
          const double gray
              = 255 * interpolate(values, columns, rows, (x + 0.5) / width, (y + 0.5) / height)
                / 12;
          assert_color(out, x, y, { gray, gray, gray }, 0.51);
        }
    }
}

CHECK_TEST(test_tall_pictures)
{
  // Groups of rows share an interpolation. The error is at most the steps of these rows.
  constexpr int kWidth = 4;
  constexpr int kHeight = 1080;
  const std::vector<gfloat> values{ 0, 1 };
  GstBuffer *frame = make_frame("RGB", kWidth, kHeight, kPicture);
  add_saliency(frame, 1, 2, values);
  const Picture out = overlay(frame, "RGB", kWidth, kHeight, "style=saliency");
  for (int y = 0; y < kHeight; y++) {
    const double gray = 255 * interpolate(values, 1, 2, 0.5, (y + 0.5) / kHeight);
    assert_color(out, 2, y, { gray, gray, gray }, 0.51 + 2 * 255 * 2.0 / kHeight);
  }
}

CHECK_TEST(test_saliency_scale)
{
  const struct
  {
    gfloat value;
    gfloat floor;
    double gray;
  } cases[] = {
    { 5, 0, 255 }, { 5, 1, 255 }, { 5, 2.5F, 255 }, { 5, 5, 127.5 }, { 5, 20, 255 * 5 / 40.0 },
    { 0, 1, 0 },   { 0, 0, 0 }
  };
  for (const auto &[value, floor, gray] : cases)
    for (const std::string format : kFormats) {
      GstBuffer *frame = make_frame(format, 8, 8, kPicture);
      add_saliency(frame, 1, 1, { value }, floor);
      assert_color(overlay(frame, format, 8, 8, "style=saliency"), 4, 4, { gray, gray, gray },
                   tolerance_of(format));
    }

  GstBuffer *frame = make_frame("RGB", 8, 8, kPicture); // the heat map has the same scale
  add_saliency(frame, 1, 1, { 5 }, 5);
  assert_color(overlay(frame, "RGB", 8, 8, "style=heatmap opacity=1"), 4, 4, { 0, 255, 0 }, 3);
}

static std::vector<guint8>
bytes_of(GstBuffer *buffer)
{
  std::vector<guint8> bytes(gst_buffer_get_size(buffer));
  gst_buffer_extract(buffer, 0, bytes.data(), bytes.size());
  return bytes;
}

CHECK_TEST(test_nothing_to_draw)
{
  for (const std::string format : kFormats)
    for (const std::string style : { "grid", "heatmap", "saliency" }) {
      GstHarness *h = gst_harness_new_parse(("tactileoverlay style=" + style).c_str());
      gst_harness_set_src_caps_str(h, caps_of(format, 33, 17).c_str());
      GstCaps *caps = gst_pad_get_current_caps(h->srcpad);
      GstVideoInfo info;
      fail_unless(gst_video_info_from_caps(&info, caps));
      gst_caps_unref(caps);
      GstBuffer *in = gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&info), nullptr);
      gst_buffer_memset(in, 0, 0x5a, -1);
      const GstBuffer *same = in;
      GstMemory *memory = gst_buffer_peek_memory(in, 0);
      GstBuffer *out = gst_harness_push_and_pull(h, in);
      fail_unless(out == same && gst_buffer_peek_memory(out, 0) == memory);
      fail_unless(std::ranges::all_of(bytes_of(out), [](int v) { return v == 0x5a; }));

      // The same for a map with an opacity of 0.
      if (style != "saliency") {
        GstElement *element = gst_harness_find_element(h, "tactileoverlay");
        g_object_set(element, "opacity", 0.0, nullptr);
        gst_object_unref(element);
        add_levels(out, 2, 2, { 1, 0.5F, 0.2F, 0 });
        out = gst_harness_push_and_pull(h, out);
        fail_unless(std::ranges::all_of(bytes_of(out), [](int v) { return v == 0x5a; }), "%s %s",
                    format.c_str(), style.c_str());
      }
      gst_buffer_unref(out);
      gst_harness_teardown(h);
    }
}

CHECK_TEST(test_alpha_and_padding_stay)
{
  for (const auto &[format, place] :
       { std::pair{ "RGBA", 3 }, { "BGRx", 3 }, { "ARGB", 0 }, { "xBGR", 0 } })
    for (const std::string style : { "grid", "heatmap", "saliency" }) {
      GstHarness *h = gst_harness_new_parse(("tactileoverlay opacity=1 style=" + style).c_str());
      gst_harness_set_src_caps_str(h, caps_of(format, 40, 40).c_str());
      GstBuffer *in = gst_buffer_new_allocate(nullptr, 40 * 40 * 4, nullptr);
      gst_buffer_memset(in, 0, 7, -1);
      add_levels(in, 1, 1, { 1 });
      add_saliency(in, 1, 1, { 1 });
      GstBuffer *out = gst_harness_push_and_pull(h, in);
      const std::vector<guint8> bytes = bytes_of(out);
      std::size_t others = 0;
      for (std::size_t i = 0; i < bytes.size(); i++) {
        if (i % 4 == static_cast<std::size_t>(place))
          fail_unless(bytes[i] == 7);
        else
          others += bytes[i] != 7;
      }
      fail_unless(others > bytes.size() / 2);
      gst_buffer_unref(out);
      gst_harness_teardown(h);
    }
}

/// Draws into a frame whose rows have `padding` extra bytes of 0xa5, which must not change. Returns
/// the samples without the padding.
static std::vector<guint8>
draw_with_padding(const std::string &format, int width, int height, const std::string &properties,
                  guint padding)
{
  GstHarness *h = gst_harness_new_parse(("tactileoverlay " + properties).c_str());
  gst_harness_set_src_caps_str(h, caps_of(format, width, height).c_str());
  GstCaps *caps = gst_pad_get_current_caps(h->srcpad);
  GstVideoInfo info;
  fail_unless(gst_video_info_from_caps(&info, caps));
  gst_caps_unref(caps);

  std::array<gsize, GST_VIDEO_MAX_PLANES> offset{};
  std::array<gint, GST_VIDEO_MAX_PLANES> stride{};
  std::array<gsize, GST_VIDEO_MAX_PLANES> rows{};
  gsize size = padding;
  for (guint p = 0; p < GST_VIDEO_INFO_N_PLANES(&info); p++) {
    const gsize end = p + 1 < GST_VIDEO_INFO_N_PLANES(&info)
                          ? GST_VIDEO_INFO_PLANE_OFFSET(&info, p + 1)
                          : GST_VIDEO_INFO_SIZE(&info);
    rows[p] = (end - GST_VIDEO_INFO_PLANE_OFFSET(&info, p))
              / static_cast<gsize>(GST_VIDEO_INFO_PLANE_STRIDE(&info, p));
    offset[p] = size;
    stride[p] = GST_VIDEO_INFO_PLANE_STRIDE(&info, p) + static_cast<gint>(padding);
    size += rows[p] * static_cast<gsize>(stride[p]);
  }
  GstBuffer *buffer = gst_buffer_new_allocate(nullptr, size, nullptr);
  gst_buffer_memset(buffer, 0, 0xa5, -1);
  gst_buffer_add_video_meta_full(buffer, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_INFO_FORMAT(&info),
                                 static_cast<guint>(width), static_cast<guint>(height),
                                 GST_VIDEO_INFO_N_PLANES(&info), offset.data(), stride.data());
  add_levels(buffer, 3, 2, { 0.1F, 0.9F, 0.4F, 1, 0, 0.6F });
  add_saliency(buffer, 2, 2, { 1, 2, 3, 4 }, 0.5F);
  GstBuffer *out = gst_harness_push_and_pull(h, buffer);
  const std::vector<guint8> bytes = bytes_of(out);
  std::vector<guint8> samples;
  fail_unless(std::all_of(bytes.begin(), bytes.begin() + padding, [](int v) { return v == 0xa5; }));
  for (guint p = 0; p < GST_VIDEO_INFO_N_PLANES(&info); p++)
    for (gsize r = 0; r < rows[p]; r++) {
      const auto row = bytes.begin()
                       + static_cast<std::ptrdiff_t>(offset[p] + r * static_cast<gsize>(stride[p]));
      const auto end = row + GST_VIDEO_INFO_PLANE_STRIDE(&info, p);
      samples.insert(samples.end(), row, end);
      fail_unless(std::all_of(end, end + static_cast<std::ptrdiff_t>(padding),
                              [](int v) { return v == 0xa5; }),
                  "%s", format.c_str());
    }
  gst_buffer_unref(out);
  gst_harness_teardown(h);
  return samples;
}

CHECK_TEST(test_any_stride_and_size)
{
  for (const std::string format : kFormats)
    for (const std::string style : { "style=grid", "style=heatmap", "style=saliency" })
      for (const auto &[width, height] :
           { std::pair{ 1, 1 }, { 3, 1 }, { 1, 5 }, { 17, 9 }, { 67, 51 } }) {
        const auto tight = draw_with_padding(format, width, height, style, 0);
        const auto padded = draw_with_padding(format, width, height, style, 64);
        fail_unless(tight == padded, "%s %s %d x %d", format.c_str(), style.c_str(), width, height);
        fail_unless(std::ranges::any_of(tight, [](int v) { return v != 0xa5; }), "%s %s %d x %d",
                    format.c_str(), style.c_str(), width, height);
      }
}

CHECK_TEST(test_largest_grid)
{
  for (const auto &[width, height] :
       { std::pair{ 1, 1 }, { 30, 100 }, { 64, 64 }, { 1100, 700 } }) {
    GstBuffer *frame = make_frame("RGB", width, height, kPicture);
    add_levels(frame, 64, 64, std::vector<gfloat>(64 * 64, 1.0F));
    const Picture out = overlay(frame, "RGB", width, height, "opacity=1");
    for (const Color &got : out.pixels) // every pixel is a cell's or a border's
      fail_unless(got.red == 255
                  && ((got.green == 0 && got.blue == 0) || (got.green == 255 && got.blue == 255)));
  }
}

CHECK_TEST(test_shared_frames)
{
  // A frame that someone else holds is copied and not modified.
  GstHarness *h = gst_harness_new_parse("tactileoverlay");
  gst_harness_set_src_caps_str(h, caps_of("GRAY8", 32, 32).c_str());
  GstBuffer *in = gst_buffer_new_allocate(nullptr, 32 * 32, nullptr);
  gst_buffer_memset(in, 0, 9, -1);
  add_levels(in, 1, 1, { 1 });
  GstBuffer *out = gst_harness_push_and_pull(h, gst_buffer_ref(in));
  fail_unless(std::ranges::all_of(bytes_of(in), [](int v) { return v == 9; }));
  fail_if(std::ranges::all_of(bytes_of(out), [](int v) { return v == 9; }));
  fail_unless(gst_buffer_get_tactile_meta(out) != nullptr);
  gst_buffer_unref(in);
  gst_buffer_unref(out);
  gst_harness_teardown(h);
}

CHECK_TEST(test_warning_without_saliency)
{
  GstHarness *h = gst_harness_new_parse("tactileoverlay style=saliency");
  GstElement *element = gst_harness_find_element(h, "tactileoverlay");
  const ElementBus messages(element);
  gst_harness_set_src_caps_str(h, caps_of("GRAY8", 9, 3).c_str());
  for (int i = 0; i < 3; i++) {
    GstBuffer *in = gst_buffer_new_allocate(nullptr, 12 * 3, nullptr);
    gst_buffer_memset(in, 0, 9, -1);
    if (i > 0) // a frame without metas causes no warning
      add_levels(in, 1, 2, { 0, 1 });
    GstBuffer *out = gst_harness_push_and_pull(h, in);
    const std::vector<guint8> bytes = bytes_of(out);
    fail_unless_equals_int(bytes[0], i == 0 ? 9 : 0); // it draws the levels
    fail_unless_equals_int(bytes[8], i == 0 ? 9 : 255);
    gst_buffer_unref(out);
    if (i == 0)
      fail_if(gst_bus_have_pending(messages.bus));
  }
  assert_contains(messages.said(GST_MESSAGE_WARNING).text,
                  { "set attach-saliency=true on saliencytactile" });
  fail_if(messages.has(GST_MESSAGE_WARNING)); // only once
  gst_object_unref(element);
  gst_harness_teardown(h);
}

CHECK_TEST(test_properties)
{
  GstHarness *h = gst_harness_new_parse("tactileoverlay");
  GstElement *element = gst_harness_find_element(h, "tactileoverlay");
  gint style = -1;
  gdouble opacity = -1;
  g_object_get(element, "style", &style, "opacity", &opacity, nullptr);
  fail_unless_equals_int(style, 0);
  fail_unless_equals_float(opacity, 0.5);
  for (const gchar *name : { "style", "opacity" }) {
    const GParamSpec *spec = g_object_class_find_property(G_OBJECT_GET_CLASS(element), name);
    fail_unless((spec->flags & GST_PARAM_CONTROLLABLE) != 0
                && (spec->flags & GST_PARAM_MUTABLE_PLAYING) != 0);
  }

  // Changes apply from frame to frame.
  gst_harness_set_src_caps_str(h, caps_of("GRAY8", 8, 8).c_str());
  const auto center = [&] {
    GstBuffer *in = gst_buffer_new_allocate(nullptr, 64, nullptr);
    gst_buffer_memset(in, 0, 100, -1);
    add_levels(in, 1, 1, { 1 });
    GstBuffer *out = gst_harness_push_and_pull(h, in);
    const int value = bytes_of(out)[4 * 8 + 4];
    gst_buffer_unref(out);
    return value;
  };
  const double red = 0.299 * 255;
  g_object_set(element, "opacity", 1.0, nullptr);
  fail_unless(std::abs(center() - red) <= 1);
  g_object_set(element, "opacity", 0.25, nullptr);
  fail_unless(std::abs(center() - (100 + 0.25 * (red - 100))) <= 1);
  gst_util_set_object_arg(G_OBJECT(element), "style", "saliency");
  g_object_get(element, "style", &style, nullptr);
  fail_unless_equals_int(style, 2);
  fail_unless_equals_int(center(), 255);
  gst_object_unref(element);
  gst_harness_teardown(h);
}

/// The meter: white up to the peak as a share of four floors, a red mark at one floor, above it the
/// picture. Without a floor there is none.
CHECK_TEST(test_meter)
{
  constexpr int kWidth = 242;
  constexpr int kHeight = 120; // the meter's is 2, with half-height chroma, too
  for (const std::string format : { "I420", "RGB", "NV12", "P010_10LE", "YUY2" })
    for (const gfloat peak : { 0.0F, 0.5F, 2.0F, 9.0F })
      for (const gfloat floor : { 0.0F, 0.5F, 1.0F }) {
        GstBuffer *frame = make_frame(format, kWidth, kHeight, kPicture);
        add_saliency(frame, 2, 1, { 0, peak }, floor);
        const Picture out
            = overlay(frame, format, kWidth, kHeight, "style=grid meter=true opacity=0.8");
        const double tolerance = tolerance_of(format);
        const double end = 240 * std::min(1.0, static_cast<double>(peak) / (4.0 * floor));
        for (int x = 3; x < kWidth; x += 6) { // away from the edges of the bar
          assert_color(out, x, kHeight - 4, kPicture, tolerance);
          if (floor == 0)
            assert_color(out, x, kHeight - 1, kPicture, tolerance);
          else if (x != 57 && x != 63 && x < end)
            assert_color(out, x, kHeight - 1, mix(kPicture, kWhite, 0.8), tolerance);
          else if (x != 57 && x != 63)
            assert_color(out, x, kHeight - 1, mix(kPicture, { 0, 0, 0 }, 0.4), tolerance);
        }
        if (floor > 0)
          assert_color(out, 60, kHeight - 1, mix(kPicture, { 255, 0, 0 }, 0.8), tolerance);
      }
}

CHECK_MAIN(tactileoverlay)
