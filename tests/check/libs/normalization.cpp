// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/normalization.h"

#include "support/saliency_oracle.h"
#include "support/tolerance.h"

#include "support/check_tests.h"

using oracle::Image;

namespace {

cv::Mat
normalized(const Image &image)
{
  cv::Mat map = oracle::to_mat(image);
  saliency::normalize_itti(map);
  return map;
}

struct Peak
{
  int x;
  int y;
  double height;
};

Image
with_peaks(std::initializer_list<Peak> peaks, double ground = 0)
{
  Image image(12, 10, ground);
  for (const auto &peak : peaks)
    image(peak.x, peak.y) = peak.height;
  return image;
}

} // namespace

CHECK_TEST(test_brute_force)
{
  unsigned seed = 0;
  for (const auto &[width, height] :
       { std::pair{ 1, 1 }, { 1, 12 }, { 12, 2 }, { 3, 3 }, { 31, 17 }, { 64, 48 } })
    for (const double high : { 0.1, 1.0, 250.0 })
      for (int i = 0; i < 20; ++i) {
        const Image image = oracle::random_image(width, height, 0, high, ++seed);
        fail_unless_at_most(oracle::difference(normalized(image), oracle::itti(image)), 1e-5);
      }
}

CHECK_TEST(test_smooth_maps)
{
  // Smooth maps have few maxima, as contrast maps do.
  for (unsigned seed = 0; seed < 50; ++seed) {
    Image image = oracle::random_image(9, 7, 0, 40, seed);
    image = oracle::up(image, 2, 2, 35, 27);
    image = oracle::pyr_down(image);
    for (double &v : image.values)
      v = static_cast<double>(static_cast<float>(v));
    fail_unless_at_most(oracle::difference(normalized(image), oracle::itti(image)), 1e-5);
  }
}

CHECK_TEST(test_one_peak_stays)
{
  const cv::Mat map = normalized(with_peaks({ { 4, 5, 37.5 } }));
  fail_unless_near(map.at<float>(5, 4), 1, 0);
  fail_unless_near(cv::sum(map)[0], 1, 0);
}

CHECK_TEST(test_two_equal_peaks_vanish)
{
  const cv::Mat map = normalized(with_peaks({ { 2, 2, 37.5 }, { 9, 7, 37.5 } }));
  fail_unless_near(cv::norm(map, cv::NORM_INF), 0, 0);
}

CHECK_TEST(test_other_peaks_suppress)
{
  // Other maxima of 1/2 and 1/4 of the span: m̄ = 3/8, so the factor is (5/8)². The background is
  // the zero of the scale.
  const cv::Mat map = normalized(with_peaks({ { 2, 2, 9 }, { 6, 2, 5 }, { 9, 7, 3 } }, 1));
  const double factor = 25.0 / 64;
  fail_unless_near(map.at<float>(2, 2), factor, 1e-6);
  fail_unless_near(map.at<float>(2, 6), factor / 2, 1e-6);
  fail_unless_near(map.at<float>(7, 9), factor / 4, 1e-6);
  fail_unless_near(map.at<float>(0, 0), 0, 0);
}

CHECK_TEST(test_three_equal_peaks_vanish)
{
  // Only one of the equal global maxima is excluded from m̄.
  const cv::Mat map = normalized(with_peaks({ { 2, 2, 8 }, { 9, 7, 8 }, { 5, 5, 8 } }));
  fail_unless_near(cv::norm(map, cv::NORM_INF), 0, 0);
}

CHECK_TEST(test_maximum_on_border_or_plateau)
{
  // The global maximum is not a local one here, so nothing is excluded from m̄ = 1/2.
  for (const auto &image : { with_peaks({ { 0, 4, 8 }, { 6, 4, 4 } }),
                             with_peaks({ { 2, 2, 8 }, { 3, 2, 8 }, { 7, 5, 4 } }) }) {
    double highest = 0;
    cv::minMaxLoc(normalized(image), nullptr, &highest);
    fail_unless_near(highest, 0.25, 1e-6);
  }
}

CHECK_TEST(test_rounding_is_no_maximum)
{
  // Two equal peaks vanish, also on a background that is flat except for rounding errors.
  Image image = with_peaks({ { 2, 2, 37.5 }, { 9, 7, 37.5 } });
  for (int i = 0; i < 5; ++i)
    image(2 + 2 * i, 5) = 3e-5;
  fail_unless_near(cv::norm(normalized(image), cv::NORM_INF), 0, 0);
}

CHECK_TEST(test_flat)
{
  for (const double value : { 0.0, 1.0, -3.0, 250.0 })
    fail_unless_near(cv::norm(normalized(Image(7, 5, value)), cv::NORM_INF), 0, 0);
  // A rounding error of L*a*b* is not a peak.
  fail_unless_near(cv::norm(normalized(with_peaks({ { 3, 3, 3e-5 } })), cv::NORM_INF), 0, 0);
  fail_unless_near(cv::norm(normalized(with_peaks({ { 3, 3, 3e-3 } })), cv::NORM_INF), 1, 0);
}

CHECK_MAIN(normalization)
