// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame/front_end.h"

#include "support/saliency_oracle.h"
#include "support/tolerance.h"

#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <random>
#include <set>

#include "support/check_tests.h"

using saliency::ColorModel;
using saliency::Component;
using saliency::FixedLabImage;
using saliency::FrameView;
using saliency::FrontEnd;

namespace {

/// The memory layout of a pixel format.
struct Layout
{
  const char *name;
  ColorModel model;
  int depth;
  int shift;
  int sub_x; ///< log2 of the chroma subsampling
  int sub_y;
  struct Place
  {
    int plane;
    int offset;       ///< bytes
    int pixel_stride; ///< bytes
  };
  std::array<Place, 3> places;
};

/// ΔE: 0.06 for the conversion, the rest for 7 fractional bits.
constexpr double kBound = 0.07;

constexpr Layout kLayouts[] = {
  { "I420", ColorModel::yuv, 8, 0, 1, 1, { { { 0, 0, 1 }, { 1, 0, 1 }, { 2, 0, 1 } } } },
  { "NV12", ColorModel::yuv, 8, 0, 1, 1, { { { 0, 0, 1 }, { 1, 0, 2 }, { 1, 1, 2 } } } },
  { "NV21", ColorModel::yuv, 8, 0, 1, 1, { { { 0, 0, 1 }, { 1, 1, 2 }, { 1, 0, 2 } } } },
  { "YUY2", ColorModel::yuv, 8, 0, 1, 0, { { { 0, 0, 2 }, { 0, 1, 4 }, { 0, 3, 4 } } } },
  { "UYVY", ColorModel::yuv, 8, 0, 1, 0, { { { 0, 1, 2 }, { 0, 0, 4 }, { 0, 2, 4 } } } },
  { "Y42B", ColorModel::yuv, 8, 0, 1, 0, { { { 0, 0, 1 }, { 1, 0, 1 }, { 2, 0, 1 } } } },
  { "Y41B", ColorModel::yuv, 8, 0, 2, 0, { { { 0, 0, 1 }, { 1, 0, 1 }, { 2, 0, 1 } } } },
  { "YUV9", ColorModel::yuv, 8, 0, 2, 2, { { { 0, 0, 1 }, { 1, 0, 1 }, { 2, 0, 1 } } } },
  { "Y444", ColorModel::yuv, 8, 0, 0, 0, { { { 0, 0, 1 }, { 1, 0, 1 }, { 2, 0, 1 } } } },
  { "AYUV", ColorModel::yuv, 8, 0, 0, 0, { { { 0, 1, 4 }, { 0, 2, 4 }, { 0, 3, 4 } } } },
  { "RGB", ColorModel::rgb, 8, 0, 0, 0, { { { 0, 0, 3 }, { 0, 1, 3 }, { 0, 2, 3 } } } },
  { "BGRx", ColorModel::rgb, 8, 0, 0, 0, { { { 0, 2, 4 }, { 0, 1, 4 }, { 0, 0, 4 } } } },
  { "GRAY8", ColorModel::gray, 8, 0, 0, 0, { { { 0, 0, 1 }, {}, {} } } },
  { "I420_10LE", ColorModel::yuv, 10, 0, 1, 1, { { { 0, 0, 2 }, { 1, 0, 2 }, { 2, 0, 2 } } } },
  { "P010_10LE", ColorModel::yuv, 10, 6, 1, 1, { { { 0, 0, 2 }, { 1, 0, 4 }, { 1, 2, 4 } } } },
  { "RGB48", ColorModel::rgb, 16, 0, 0, 0, { { { 0, 0, 6 }, { 0, 2, 6 }, { 0, 4, 6 } } } },
  { "NV16", ColorModel::yuv, 8, 0, 1, 0, { { { 0, 0, 1 }, { 1, 0, 2 }, { 1, 1, 2 } } } },
  { "NV24", ColorModel::yuv, 8, 0, 0, 0, { { { 0, 0, 1 }, { 1, 0, 2 }, { 1, 1, 2 } } } },
};

int
subsampled(int length, int k)
{
  return (length + (1 << k) - 1) / (1 << k);
}

/// A random frame whose planes have no spare bytes, so that a sanitizer sees every read beyond
/// them.
struct Frame
{
  FrameView view;
  std::array<oracle::Image, 3> codes; ///< what was written
  std::array<std::unique_ptr<std::uint8_t[]>, 3> memory;

  Frame(const Layout &layout, int width, int height, bool bottom_up, unsigned seed)
  {
    std::mt19937 generator(seed);
    const std::size_t count = layout.model == ColorModel::gray ? 1 : 3;
    const int bytes = layout.depth > 8 ? 2 : 1;

    std::array<std::ptrdiff_t, 3> row_bytes{};
    std::array<std::ptrdiff_t, 3> rows{};
    for (std::size_t i = 0; i < count; ++i) {
      const auto &place = layout.places[i];
      const auto plane = static_cast<std::size_t>(place.plane);
      auto &component = view.components[i];
      component.width = i == 0 ? width : subsampled(width, layout.sub_x);
      component.height = i == 0 ? height : subsampled(height, layout.sub_y);
      component.pixel_stride = place.pixel_stride;
      row_bytes[plane] = std::max<std::ptrdiff_t>(
          row_bytes[plane], place.offset + (component.width - 1) * place.pixel_stride + bytes);
      rows[plane] = component.height;
    }
    for (std::size_t p = 0; p < 3; ++p) {
      const auto size = static_cast<std::size_t>(row_bytes[p] * rows[p]);
      memory[p] = std::make_unique<std::uint8_t[]>(size);
      for (std::size_t i = 0; i < size; ++i)
        memory[p][i] = static_cast<std::uint8_t>(generator());
    }

    view.width = width;
    view.height = height;
    view.model = layout.model;
    view.depth = layout.depth;
    view.shift = layout.shift;
    view.matrix = saliency::kBt601;
    for (std::size_t i = 0; i < count; ++i) {
      const auto &place = layout.places[i];
      const auto plane = static_cast<std::size_t>(place.plane);
      auto &component = view.components[i];
      component.data = memory[plane].get() + place.offset;
      component.row_stride = row_bytes[plane];
      if (bottom_up) {
        component.data += row_bytes[plane] * (rows[plane] - 1);
        component.row_stride = -component.row_stride;
      }
      codes[i] = oracle::Image(component.width, component.height);
      for (int y = 0; y < component.height; ++y)
        for (int x = 0; x < component.width; ++x) {
          const auto *p = component.data + y * component.row_stride + x * component.pixel_stride;
          const int word = bytes == 1 ? p[0] : p[0] + 256 * p[1];
          codes[i](x, y) = (word >> layout.shift) % (1 << layout.depth);
        }
    }
  }
};

oracle::LabImage
to_lab(const FrameView &view, const std::array<oracle::Image, 3> &codes)
{
  const int w = codes[0].width;
  const int h = codes[0].height;
  oracle::LabImage lab{ oracle::Image(w, h), oracle::Image(w, h), oracle::Image(w, h) };
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      std::array<double, 3> code{};
      for (std::size_t i = 0; i < (view.model == ColorModel::gray ? 1U : 3U); ++i)
        code[i] = codes[i](x, y);
      const auto pixel
          = oracle::samples_to_lab(code, view.model, view.depth, view.full_range, view.matrix);
      for (std::size_t c = 0; c < 3; ++c)
        lab[c](x, y) = pixel[c];
    }
  return lab;
}

/// A component on the grid of a level. pyr_down does what subsampling left to do, interpolation
/// undoes what it did too much. The length of an axis tells how often it was halved: an axis of one
/// sample was not.
oracle::Image
component_at(const oracle::Image &codes, int level, int width, int height)
{
  int x = 0;
  int y = 0;
  while (subsampled(width, x) > codes.width)
    ++x;
  while (subsampled(height, y) > codes.height)
    ++y;
  oracle::Image image = codes;
  for (; x < level && y < level; ++x, ++y)
    image = oracle::pyr_down(image);
  for (; x < level; ++x)
    image = oracle::pyr_down(image, true, false);
  for (; y < level; ++y)
    image = oracle::pyr_down(image, false, true);
  if (x > level || y > level)
    image = oracle::up(image, x - level, y - level, subsampled(width, level),
                       subsampled(height, level));
  return image;
}

oracle::LabImage
expected_lab(const Frame &frame, int level, int converted)
{
  std::array<oracle::Image, 3> components;
  for (std::size_t i = 0; i < (frame.view.model == ColorModel::gray ? 1U : 3U); ++i)
    components[i] = component_at(frame.codes[i], converted, frame.view.width, frame.view.height);
  auto lab = to_lab(frame.view, components);
  for (int n = converted; n < level; ++n)
    lab = oracle::pyr_down(lab);
  return lab;
}

/// Conversion levels: first, last but one, last.
std::set<int>
conversions(int level)
{
  return { 0, std::max(0, level - 1), level };
}

bool
refuses(const FrameView &view)
{
  return !fault_of(view).empty();
}

} // namespace

CHECK_LOOP_TEST(test_layouts, 0, std::size(kLayouts))
{
  const Layout &layout = kLayouts[__i__];
  unsigned seed = 1;
  for (const auto &[width, height] : { std::pair{ 1, 1 },
                                       { 1, 7 },
                                       { 9, 1 },
                                       { 2, 2 },
                                       { 5, 3 },
                                       { 16, 9 },
                                       { 33, 18 },
                                       { 4, 16 },
                                       { 35, 17 },
                                       { 150, 19 } })
    for (const bool bottom_up : { false, true })
      for (int level = 0; (std::max(width, height) - 1) >> level > 0 || level == 0; ++level)
        for (const int converted : conversions(level)) {
          const Frame frame(layout, width, height, bottom_up, ++seed);
          FrontEnd front_end;
          const double e = oracle::difference(front_end.lab(frame.view, level, converted),
                                              expected_lab(frame, level, converted));
          fail_unless(e <= kBound, "%s %dx%d level %d, converted at %d: ΔE %g", layout.name, width,
                      height, level, converted, e);
        }
}

static FixedLabImage
clone(const FixedLabImage &image)
{
  return { { image.planes[0].clone(), image.planes[1].clone(), image.planes[2].clone() } };
}

/// Whether two images are bit-identical.
static bool
same(const FixedLabImage &a, const FixedLabImage &b)
{
  for (std::size_t c = 0; c < 3; ++c)
    if (a.planes[c].size() != b.planes[c].size()
        || std::memcmp(a.planes[c].data, b.planes[c].data,
                       a.planes[c].total() * sizeof(saliency::Fixed))
               != 0)
      return false;
  return true;
}

CHECK_TEST(test_large_frame)
{
  for (const int layout : { 0, 10, 13 }) {
    const Frame frame(kLayouts[layout], 800, 760, false, 11);
    FrontEnd front_end;
    for (const int level : { 1, 2, 3 })
      for (const int converted : std::set<int>{ std::max(1, level - 1), level }) {
        const double e = oracle::difference(front_end.lab(frame.view, level, converted),
                                            expected_lab(frame, level, converted));
        fail_unless(e <= kBound, "%s level %d, converted at %d: ΔE %g", kLayouts[layout].name,
                    level, converted, e);
      }
  }
}

CHECK_TEST(test_decimation_level)
{
  // A frame is decimated first, to the finest level that is small enough.
  const auto level = saliency::decimation_level;
  for (const cv::Size few : { cv::Size(1, 1), { 320, 240 }, { 500, 300 } })
    for (int n = 0; n < 5; ++n)
      ck_assert_int_eq(level(few, n), 0);
  ck_assert_int_eq(level({ 501, 300 }, 0), 0);
  ck_assert_int_eq(level({ 501, 300 }, 3), 1);
  ck_assert_int_eq(level({ 640, 480 }, 3), 1);
  ck_assert_int_eq(level({ 800, 600 }, 3), 1);
  ck_assert_int_eq(level({ 1000, 1000 }, 2), 2);
  ck_assert_int_eq(level({ 1000, 1000 }, 3), 2);
  ck_assert_int_eq(level({ 1280, 720 }, 2), 2);
  ck_assert_int_eq(level({ 1920, 1080 }, 3), 2);
  ck_assert_int_eq(level({ 1920, 1080 }, 5), 2);
  ck_assert_int_eq(level({ 3840, 2160 }, 4), 3);
  ck_assert_int_eq(level({ 4000, 600 }, 3), 2);
  ck_assert_int_eq(level({ 4001, 600 }, 3), 3);
}

CHECK_LOOP_TEST(test_targets, 0, std::size(kLayouts))
{
  // Results are bit-identical with all instruction sets of this CPU.
  const Layout &layout = kLayouts[__i__];
  const auto targets = hwy::SupportedTargets();
  for (const auto &[width, height] : { std::pair{ 1, 1 }, { 70, 9 }, { 331, 42 }, { 260, 34 } })
    for (const int level : { 0, 1, 3 })
      for (const int converted : conversions(level)) {
        const Frame frame(layout, width, height, false, 3);
        const FixedLabImage expected = clone(FrontEnd().lab(frame.view, level, converted));
        for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
          hwy::GetChosenTarget().Update(target);
          FrontEnd front_end;
          const bool equal = same(front_end.lab(frame.view, level, converted), expected);
          hwy::GetChosenTarget().Update(targets);
          fail_unless(equal, "%s: %s %dx%d level %d, converted at %d", hwy::TargetName(target),
                      layout.name, width, height, level, converted);
        }
      }
}

CHECK_LOOP_TEST(test_threads, 0, std::size(kLayouts))
{
  // Bit-identical for any number of threads, also with more threads than rows, frame after frame.
  const Layout &layout = kLayouts[__i__];
  for (const int threads : { 0, 2, 3, 8 }) {
    FrontEnd front_end;
    front_end.set_threads(threads);
    for (const auto &[width, height] : { std::pair{ 1, 1 }, { 7, 2 }, { 131, 93 } })
      for (const int level : { 0, 2, 4 })
        for (const int converted : conversions(level))
          for (unsigned seed = 0; seed < 3; ++seed) {
            const Frame frame(layout, width, height, seed == 1, seed);
            fail_unless(same(front_end.lab(frame.view, level, converted),
                             clone(FrontEnd().lab(frame.view, level, converted))),
                        "%d threads: %s %dx%d level %d, converted at %d", threads, layout.name,
                        width, height, level, converted);
          }
  }
}

CHECK_LOOP_TEST(test_rows_of_pages, 0, std::size(kLayouts))
{
  // Prefetching must not read beyond the frame: a sanitizer sees it.
  const Layout &layout = kLayouts[__i__];
  constexpr int kWidth = 4200;
  for (const bool bottom_up : { false, true })
    for (const int height : { 270, 281 }) {
      const Frame frame(layout, kWidth, height, bottom_up, 5);
      const FixedLabImage wide = clone(FrontEnd().lab(frame.view, 3, 3));
      FrontEnd shared;
      shared.set_threads(3);
      fail_unless(same(shared.lab(frame.view, 3, 3), wide), "%s", layout.name);
    }
}

CHECK_TEST(test_reuse)
{
  // One front end that changes from each format and size to each other one: nothing of an earlier
  // frame remains.
  std::vector<const Layout *> layouts;
  for (const auto &from : kLayouts)
    for (const auto &to : kLayouts)
      layouts.insert(layouts.end(), { &from, &to });
  for (const int converted : conversions(3)) {
    FrontEnd front_end;
    unsigned seed = 77;
    for (const auto &[width, height] : { std::pair{ 40, 30 }, { 7, 5 }, { 40, 30 } })
      for (const Layout *next : layouts) {
        const Layout &layout = *next;
        const Frame frame(layout, width, height, false, ++seed);
        const double e = oracle::difference(front_end.lab(frame.view, 3, converted),
                                            expected_lab(frame, 3, converted));
        fail_unless(e <= kBound, "%s: ΔE %g", layout.name, e);
      }
  }
}

CHECK_TEST(test_decimating_first_is_close)
{
  // A picture without noise: a sum of waves, saturated in places.
  Frame frame(kLayouts[8], 200, 160, false, 5);
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < 160; ++y)
      for (int x = 0; x < 200; ++x)
        frame.memory[static_cast<std::size_t>(c)][static_cast<std::size_t>(y * 200 + x)]
            = static_cast<std::uint8_t>(std::lround(
                128 + (c == 0 ? 100 : 40) * std::sin(0.11 * x + c) * std::cos(0.07 * y - c)));
  FrontEnd exact;
  FrontEnd fast;
  const auto a = saliency::to_float(exact.lab(frame.view, 2, 0)).planes;
  const auto b = saliency::to_float(fast.lab(frame.view, 2, 1)).planes;
  double sum = 0;
  for (int y = 0; y < a[0].rows; ++y)
    for (int x = 0; x < a[0].cols; ++x)
      sum += std::hypot(a[0].at<float>(y, x) - b[0].at<float>(y, x),
                        a[1].at<float>(y, x) - b[1].at<float>(y, x),
                        a[2].at<float>(y, x) - b[2].at<float>(y, x));
  fail_unless_at_most(sum / static_cast<double>(a[0].total()), 0.3);
}

CHECK_TEST(test_invalid_frames)
{
  const Frame frame(kLayouts[0], 8, 6, false, 1);
  const auto with = [&](auto change) {
    FrameView view = frame.view;
    change(view);
    return view;
  };
  fail_if(refuses(frame.view));
  fail_unless(refuses({}));
  fail_unless(refuses(with([](FrameView &v) { v.width = 0; })));
  fail_unless(refuses(with([](FrameView &v) { v.height = -6; })));
  fail_unless(refuses(with([](FrameView &v) { v.width = 9; })));
  fail_unless(refuses(with([](FrameView &v) { v.depth = 7; })));
  fail_unless(refuses(with([](FrameView &v) { v.depth = 10; }))); // 8-bit samples of 10 bits
  fail_unless(refuses(with([](FrameView &v) { v.shift = 1; })));
  fail_unless(refuses(with([](FrameView &v) { v.matrix = { 0, 0 }; })));
  for (std::size_t i = 0; i < 3; ++i) {
    fail_unless(refuses(with([i](FrameView &v) { v.components[i].data = nullptr; })));
    fail_unless(refuses(with([i](FrameView &v) { v.components[i].width = 0; })));
    fail_unless(refuses(with([i](FrameView &v) { v.components[i].height = -1; })));
    fail_unless(refuses(with([i](FrameView &v) { v.components[i].width = 100; })));
    fail_unless(refuses(with([i](FrameView &v) { v.components[i].pixel_stride = 0; })));
  }
  // The other components of a gray frame are not checked.
  fail_if(refuses(with([](FrameView &v) {
    v.model = ColorModel::gray;
    v.components[1] = v.components[2] = {};
  })));
}

CHECK_MAIN(front_end)
