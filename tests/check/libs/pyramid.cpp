// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/pyramid.h"

#include "support/saliency_oracle.h"
#include "support/tolerance.h"

#include <cmath>
#include <stdexcept>

#include "support/check_tests.h"

using oracle::Image;

namespace {

constexpr int kLengths[]
    = { 1, 2, 3, 4, 5, 6, 7, 8, 15, 16, 17, 31, 32, 33, 34, 35, 36, 37, 38, 66, 67, 99, 130, 131 };

} // namespace

CHECK_TEST(test_geometry)
{
  ck_assert_int_eq(saliency::coarsest_level({ 1, 1 }), 0);
  ck_assert_int_eq(saliency::coarsest_level({ 2, 1 }), 1);
  ck_assert_int_eq(saliency::coarsest_level({ 1, 3 }), 2);
  // the paper's 2^N × 2^N has levels 0…N
  ck_assert_int_eq(saliency::coarsest_level({ 256, 256 }), 8);
  ck_assert_int_eq(saliency::coarsest_level({ 1920, 1080 }), 11);
  for (const auto &[width, height] : { std::pair{ 1, 1 }, { 5, 2 }, { 1920, 1080 }, { 641, 1 } })
    for (int level = 0; level < 13; ++level) {
      const auto size = saliency::level_size({ width, height }, level);
      ck_assert_int_eq(size.width, static_cast<int>(std::ceil(width / std::pow(2.0, level))));
      ck_assert_int_eq(size.height, static_cast<int>(std::ceil(height / std::pow(2.0, level))));
    }
}

CHECK_TEST(test_reduce)
{
  // Rows shorter and longer than vectors, with one object for all sizes.
  saliency::Reduction reduce;
  unsigned seed = 0;
  for (const int width : kLengths)
    for (const int height : { 1, 2, 3, 4, 5, 6, 9, 18 }) {
      const Image image = oracle::random_image(width, height, -100, 100, ++seed);
      cv::Mat reduced;
      reduce(oracle::to_mat(image), reduced);
      fail_unless_at_most(oracle::difference(reduced, oracle::pyr_down(image)), 1e-4);
    }
}

CHECK_TEST(test_upsample)
{
  unsigned seed = 0;
  for (const auto &[width, height] :
       { std::pair{ 1, 1 }, { 1, 20 }, { 17, 1 }, { 33, 20 }, { 64, 48 } })
    for (int octaves_x = 0; octaves_x <= 6; ++octaves_x)
      for (int octaves_y = 0; octaves_y <= 6; octaves_y += 2) {
        const int w = saliency::level_size({ width, 1 }, octaves_x).width;
        const int h = saliency::level_size({ 1, height }, octaves_y).height;
        const Image coarse = oracle::random_image(w, h, -100, 100, ++seed);
        cv::Mat up;
        saliency::upsample(oracle::to_mat(coarse), octaves_x, octaves_y, { width, height }, up);
        fail_unless_at_most(
            oracle::difference(up, oracle::up(coarse, octaves_x, octaves_y, width, height)), 1e-4);
      }
}

CHECK_TEST(test_grid)
{
  // A ramp whose value is the position. Each level's samples tell where they lie, and upsampling
  // must put them back there.
  constexpr int kWidth = 257;
  constexpr int kHeight = 129;
  Image ramp(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      ramp(x, y) = x + 1000.0 * y;

  saliency::Pyramid pyramid;
  const cv::Mat image = oracle::to_mat(ramp);
  pyramid.build({ { image, image, image } }, 0, 4);
  for (int n = 1; n <= 4; ++n) {
    const int step = 1 << n;
    cv::Mat up;
    const cv::Mat &level = pyramid.level(n).lightness();
    saliency::upsample(level, n, n, { kWidth, kHeight }, up);
    // The mirrored border bends the ramp by up to 2 samples of each level, in all 4·2ⁿ pixels.
    const int margin = 4 * step;
    for (int y = margin; y < kHeight - margin; ++y)
      for (int x = margin; x < kWidth - margin; ++x) {
        fail_unless_near(up.at<float>(y, x), ramp(x, y), 0.05);
        if (x % step == 0 && y % step == 0)
          fail_unless_near(level.at<float>(y / step, x / step), ramp(x, y), 0.05);
      }
  }

  // Without the bend at the borders upsampling is exact everywhere.
  for (int n = 1; n <= 6; ++n) {
    Image positions(kWidth / (1 << n) + 1, kHeight / (1 << n) + 1);
    for (int y = 0; y < positions.height; ++y)
      for (int x = 0; x < positions.width; ++x)
        positions(x, y) = ((x + 2.0 * y) * (1 << n));
    cv::Mat up;
    saliency::upsample(oracle::to_mat(positions), n, n, { kWidth, kHeight }, up);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        fail_unless_near(up.at<float>(y, x), x + 2.0 * y, 0);
  }
}

CHECK_TEST(test_pyramid)
{
  saliency::Pyramid pyramid;
  // The second pyramid is smaller and starts at another level. Nothing of the first may remain.
  for (const auto &[width, height, base] :
       { std::tuple{ 100, 75, 0 }, { 13, 1, 3 }, { 100, 75, 1 } }) {
    oracle::LabImage level{ oracle::random_image(width, height, 0, 100, 1),
                            oracle::random_image(width, height, -90, 90, 2),
                            oracle::random_image(width, height, -90, 90, 3) };
    const int coarsest = base + saliency::coarsest_level({ width, height });
    pyramid.build(oracle::to_planes(level), base, coarsest);
    for (int n = base; n <= coarsest; ++n) {
      fail_unless_at_most(oracle::difference(pyramid.level(n), level), 1e-3);
      level = oracle::pyr_down(level);
    }
    ck_assert(pyramid.level(coarsest).size() == cv::Size(1, 1));
    for (const int outside : { base - 1, coarsest + 1 }) {
      bool thrown = false;
      try {
        pyramid.level(outside);
      } catch (const std::out_of_range &) {
        thrown = true;
      }
      fail_unless(thrown);
    }
  }
}

CHECK_TEST(test_fixed_point)
{
  // Agrees with float to a few units of 1/128. Chroma is only computed where requested. An image
  // lent to an earlier build is not modified.
  constexpr int kChroma = 2;
  oracle::LabImage level{ oracle::random_image(100, 75, 0, 100, 1),
                          oracle::random_image(100, 75, -90, 90, 2),
                          oracle::random_image(100, 75, -90, 90, 3) };
  saliency::FixedLabImage fixed;
  for (std::size_t c = 0; c < 3; ++c)
    oracle::to_mat(level[c]).convertTo(fixed.planes[c], CV_16U, saliency::FixedLabImage::kUnits,
                                       static_cast<double>(saliency::FixedLabImage::kUnits)
                                           * saliency::FixedLabImage::kOffset);
  const saliency::LabImage lent = oracle::to_planes(oracle::LabImage{
      oracle::Image(100, 75, 7), oracle::Image(100, 75, 7), oracle::Image(100, 75, 7) });
  saliency::Pyramid pyramid;
  pyramid.build(lent, 0, 4);
  pyramid.build(fixed, 0, 4, kChroma);
  for (int n = 0; n <= 4; ++n) {
    for (std::size_t c = 0; c < 3; ++c)
      if (c == 0 || n >= kChroma)
        fail_unless_at_most(oracle::difference(pyramid.level(n).planes[c], level[c]), 0.05);
      else
        fail_unless(pyramid.level(n).planes[c].empty());
    level = oracle::pyr_down(level);
  }
  for (const auto &plane : lent.planes)
    fail_unless_at_most(oracle::difference(plane, oracle::Image(100, 75, 7)), 0);
}

CHECK_MAIN(pyramid)
