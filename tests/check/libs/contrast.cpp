// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/contrast.h"

#include "saliency/pyramid.h"
#include "support/saliency_oracle.h"
#include "support/tolerance.h"

#include <cmath>

#include "support/check_tests.h"

using saliency::Contrast;
using saliency::LevelPair;
using saliency::Pyramid;

namespace {

std::vector<oracle::LabImage>
levels_of(const oracle::LabImage &finest, int coarsest)
{
  std::vector<oracle::LabImage> levels{ finest };
  while (static_cast<int>(levels.size()) <= coarsest)
    levels.push_back(oracle::pyr_down(levels.back()));
  return levels;
}

oracle::LabImage
random_lab(cv::Size size, unsigned seed)
{
  return { oracle::random_image(size.width, size.height, 0, 100, seed),
           oracle::random_image(size.width, size.height, -100, 100, seed + 1),
           oracle::random_image(size.width, size.height, -100, 100, seed + 2) };
}

oracle::LabImage
uniform_lab(int width, int height, oracle::Lab lab)
{
  return { oracle::Image(width, height, lab[0]), oracle::Image(width, height, lab[1]),
           oracle::Image(width, height, lab[2]) };
}

Pyramid
pyramid_of(const oracle::LabImage &finest, int coarsest)
{
  Pyramid pyramid;
  pyramid.build(oracle::to_planes(finest), 0, coarsest);
  return pyramid;
}

} // namespace

CHECK_TEST(test_brute_force)
{
  // Lightness and chroma of the same pair of levels, or chroma of another one. Where both levels of
  // a pair are limited to the same level, its contrast is zero.
  const struct
  {
    LevelPair lightness;
    LevelPair chroma;
  } cases[] = { { { 0, 0 }, { 0, 0 } }, { { 0, 1 }, { 0, 1 } }, { { 0, 5 }, { 0, 5 } },
                { { 2, 5 }, { 2, 5 } }, { { 0, 1 }, { 1, 2 } }, { { 1, 2 }, { 3, 4 } },
                { { 0, 3 }, { 2, 3 } }, { { 0, 3 }, { 0, 1 } }, { { 0, 1 }, { 5, 5 } },
                { { 4, 5 }, { 5, 5 } }, { { 1, 1 }, { 1, 2 } } };
  unsigned seed = 0;
  for (const double weight : { 1.0, 2.0, 0.5, 0.0 }) {
    Contrast contrast(weight); // reused: buffers change size
    for (const cv::Size size :
         { cv::Size(1, 1), cv::Size(1, 9), cv::Size(20, 1), cv::Size(31, 17) }) {
      const auto lab = random_lab(size, seed += 3);
      const auto levels = levels_of(lab, 5);
      const auto pyramid = pyramid_of(lab, 5);
      for (const auto &c : cases) {
        cv::Mat map;
        contrast(pyramid, c.lightness, c.chroma, map);
        fail_unless_at_most(
            oracle::difference(map, oracle::contrast(levels, c.lightness, c.chroma, weight)), 1e-3);
      }
    }
  }
}

CHECK_TEST(test_closed_form)
{
  // A dot of (3, 4, 12) on black. One level up, its sample keeps 6/16 of it along each axis and
  // each neighbor gets 1/16. Two levels up: (6·6 + 2·4·1)/256 = 44/256.
  auto lab = uniform_lab(33, 33, { 0, 0, 0 });
  lab[0](16, 16) = 3;
  lab[1](16, 16) = 4;
  lab[2](16, 16) = 12;
  const auto pyramid = pyramid_of(lab, 2);
  const double fine = 55.0 / 64;
  const double coarse = 9.0 / 64 - std::pow(44.0 / 256, 2);
  cv::Mat map;
  Contrast(1)(pyramid, { 0, 1 }, { 0, 1 }, map);
  fail_unless_near(map.at<float>(16, 16), 13 * fine, 1e-5);
  Contrast(2)(pyramid, { 0, 1 }, { 0, 1 }, map);
  fail_unless_near(map.at<float>(16, 16), std::sqrt(649.0) * fine, 1e-5);
  Contrast(2)(pyramid, { 0, 1 }, { 1, 2 }, map);
  fail_unless_near(map.at<float>(16, 16), std::sqrt(9 * fine * fine + 4 * 160 * coarse * coarse),
                   1e-5);
}

CHECK_TEST(test_ramp_has_no_contrast)
{
  // On a linear ramp center and surround agree if samples lie where the pyramid places them.
  // Half-pixel centers would leave a contrast of (2² - 1)/2 samples' slope. Mirrored borders bend
  // the ramp: two levels up they reach 2 + 2·2 pixels, to the sample at 8.
  auto lab = uniform_lab(65, 65, { 0, 0, 0 });
  for (int y = 0; y < 65; ++y)
    for (int x = 0; x < 65; ++x) {
      lab[0](x, y) = x + 0.5 * y;
      lab[1](x, y) = 0.5 * x - y;
    }
  const auto pyramid = pyramid_of(lab, 3);
  cv::Mat map;
  Contrast(1)(pyramid, { 0, 2 }, { 0, 2 }, map);
  const cv::Rect within(8, 8, 49, 49);
  fail_unless_at_most(oracle::difference(map(within), oracle::Image(49, 49, 0)), 1e-4);
  Contrast(1)(pyramid, { 0, 2 }, { 1, 2 }, map);
  fail_unless_at_most(oracle::difference(map(within), oracle::Image(49, 49, 0)), 1e-4);
}

CHECK_MAIN(contrast)
