// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactile/picture_map.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "support/check_tests.h"

using tactile::PictureMap;
using tactile::SaliencyView;

namespace {

/// Where samples of pyramid level n of a picture of `size` pixels lie: sample i on pixel 2ⁿ i.
SaliencyView::Extent
extent_of_level(int level, int size)
{
  const double step = std::ldexp(1.0, level);
  return { 0.5 - 0.5 / step, size / step };
}

struct Map
{
  Map(int level_, int picture_width_, int picture_height_)
      : step(1 << level_), picture_width(picture_width_), picture_height(picture_height_),
        width((picture_width + step - 1) / step), height((picture_height + step - 1) / step),
        level(level_), values(static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
  {
  }

  /// Sets each sample by the pixel on which it lies.
  template <typename Function> void fill(const Function &value_at)
  {
    for (int y = 0; y < height; y++)
      for (int x = 0; x < width; x++)
        values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width)
               + static_cast<std::size_t>(x)]
            = static_cast<float>(value_at(x * step, y * step));
  }

  SaliencyView view() const
  {
    return { .values = values.data(),
             .width = width,
             .height = height,
             .stride = width,
             .horizontal = extent_of_level(level, picture_width),
             .vertical = extent_of_level(level, picture_height) };
  }

  int step;
  int picture_width;
  int picture_height;
  int width;
  int height;
  int level;
  std::vector<float> values;
};

/// The pixel at the center of sample `index` of `count` after resizing to `size` pixels.
double
pixel(int index, int count, int size)
{
  return (index + 0.5) * size / count - 0.5;
}

} // namespace

/// A spot at least as wide as a sample keeps its place when the map is resized to the picture, for
/// all sizes.
CHECK_TEST(test_spot_stays)
{
  const int sizes[][2] = { { 640, 360 }, { 633, 471 }, { 1001, 77 } };
  for (const auto &size : sizes)
    for (const int level : { 2, 4 }) {
      Map map(level, size[0], size[1]);
      const double sigma = map.step;
      for (double phase = 0; phase < 1; phase += 0.25) {
        const double x0 = size[0] * 0.4 + phase * map.step;
        const double y0 = size[1] * 0.5 - phase * map.step;
        map.fill([&](int x, int y) {
          return std::exp(-(std::pow(x - x0, 2) + std::pow(y - y0, 2)) / (2 * sigma * sigma));
        });
        PictureMap on_picture;
        on_picture.sample(map.view());
        ck_assert_int_eq(on_picture.width(), map.width);
        ck_assert_int_eq(on_picture.height(), map.height);
        double sum = 0;
        double x_sum = 0;
        for (int y = 0; y < map.height; y++)
          for (int x = 0; x < map.width; x++) {
            const double value = static_cast<double>(
                on_picture
                    .values()[static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width)
                              + static_cast<std::size_t>(x)]);
            sum += value;
            x_sum += value * pixel(x, map.width, size[0]);
          }
        fail_unless(std::abs(x_sum / sum - x0) < 0.02 * map.step, "%d level %d: %g, not %g",
                    size[0], level, x_sum / sum, x0);
      }
    }
}

/// Cubic interpolation reproduces quadratics exactly, away from the border.
CHECK_TEST(test_quadratic_is_exact)
{
  const auto value = [](double x, double y) {
    return 2 + 0.01 * x + 0.02 * y + 1e-4 * (x - 90) * (x - 90) + 2e-4 * (y - 70) * (y - 70);
  };
  Map map(3, 180, 143);
  map.fill(value);
  PictureMap on_picture;
  on_picture.sample(map.view());
  for (int y = 2; y < map.height - 2; y++)
    for (int x = 2; x < map.width - 2; x++)
      fail_unless(std::abs(static_cast<double>(
                               on_picture.values()[static_cast<std::size_t>(y * map.width + x)])
                           - value(pixel(x, map.width, 180), pixel(y, map.height, 143)))
                  < 1e-4);
}

/// A map of the picture's size stays unchanged. Values that are not finite count as 0. An empty map
/// stays empty.
CHECK_TEST(test_plain_map)
{
  const std::vector<float> values{ 1, 0, 2.5F, std::numeric_limits<float>::infinity(), 7, 3 };
  SaliencyView view{ .values = values.data(), .width = 3, .height = 2, .stride = 3 };
  PictureMap on_picture;
  on_picture.sample(view);
  fail_unless(on_picture.values() == (std::vector<float>{ 1, 0, 2.5F, 0, 7, 3 }));
  fail_unless(on_picture.peak() == 7);
  on_picture.sample({});
  fail_unless(on_picture.values().empty() && on_picture.width() == 0 && on_picture.peak() == 0);

  view = { .values = values.data(),
           .width = 1,
           .height = 1,
           .stride = 1,
           .horizontal = extent_of_level(5, 3),
           .vertical = extent_of_level(5, 2) };
  on_picture.sample(view);
  fail_unless(on_picture.values() == std::vector<float>{ 1 });
}

/// Values stay ≥ 0 where cubic interpolation would undershoot.
CHECK_TEST(test_values_are_at_least_0)
{
  Map map(4, 160, 160);
  map.fill([](int x, int y) { return x == 64 && y == 64 ? 1 : 0; });
  PictureMap on_picture;
  on_picture.sample(map.view());
  fail_unless(std::ranges::all_of(on_picture.values(), [](float value) { return value >= 0; }));
  fail_unless(on_picture.peak() > 0.25 && on_picture.peak() < 1);
}

CHECK_MAIN(picture_map)
