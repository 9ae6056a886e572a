// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/rarity.h"

#include "support/saliency_oracle.h"
#include "support/tolerance.h"

#include <cmath>
#include <utility>

#include "support/check_tests.h"

using saliency::Rarity;

namespace {

oracle::LabImage
colors(int width, int height, double l, double a = 0, double b = 0)
{
  return { oracle::Image(width, height, l), oracle::Image(width, height, a),
           oracle::Image(width, height, b) };
}

cv::Mat
weight_of(const oracle::LabImage &lab, double border = 0)
{
  Rarity rarity(border);
  cv::Mat weight;
  rarity(oracle::to_planes(lab), weight);
  return weight;
}

double
rarity_of_share(double share)
{
  return -std::log(share + 1e-4) / 5;
}

} // namespace

CHECK_TEST(test_shares)
{
  // 20×20 pixels. A plain color is not rare at all. A distant color on 4 pixels has a share of 1 %.
  auto lab = colors(20, 20, 50, -20, 30);
  fail_unless_at_most(cv::norm(weight_of(lab), cv::NORM_INF), 0);
  for (int i = 0; i < 4; ++i)
    lab[1](8 + i, 5) = 40;
  const cv::Mat weight = weight_of(lab);
  fail_unless_near(weight.at<float>(5, 8), rarity_of_share(0.01), 1e-5);
  fail_unless_near(weight.at<float>(0, 0), rarity_of_share(0.99), 1e-5);
  // Pixels of a color one bin of L* away (6.25) count half, two bins away not at all.
  lab = colors(20, 20, 53);
  for (int x = 0; x < 20; ++x)
    for (int y = 0; y < 10; ++y)
      lab[0](x, y) = 53 + 6.25;
  fail_unless_near(weight_of(lab).at<float>(0, 0), rarity_of_share(0.75), 1e-5);
  for (int x = 0; x < 20; ++x)
    for (int y = 0; y < 10; ++y)
      lab[0](x, y) = 53 + 12.5;
  fail_unless_near(weight_of(lab).at<float>(0, 0), rarity_of_share(0.5), 1e-5);
}

CHECK_TEST(test_border)
{
  // The outer 10 % of 20×30 are 2 columns and 3 rows on each side. A color that is only inside is
  // as rare as possible, and so is one that is only outside.
  auto lab = colors(20, 30, 30);
  for (int y = 3; y < 27; ++y)
    for (int x = 2; x < 18; ++x)
      lab[0](x, y) = 80;
  const cv::Mat weight = weight_of(lab, 0.1);
  fail_unless_near(weight.at<float>(15, 10), rarity_of_share(0), 1e-5);
  fail_unless_near(weight.at<float>(3, 2), rarity_of_share(0), 1e-5);
  fail_unless_near(weight.at<float>(2, 2), 0, 1e-5);
  fail_unless_near(weight.at<float>(26, 1), 0, 1e-5);
  // With one sample among the border's 20 · 30 - 16 · 24 = 216 its share is 1/216.
  lab[0](1, 15) = 80;
  fail_unless_near(weight_of(lab, 0.1).at<float>(15, 10), rarity_of_share(1.0 / 216), 1e-5);
}

CHECK_TEST(test_brute_force)
{
  // One object for pictures of changing size. Colors from the whole space and beyond.
  unsigned seed = 1;
  for (const double border : { 0.0, 0.1, 0.5 }) {
    Rarity rarity(border);
    for (const auto &[width, height] :
         { std::pair{ 1, 1 }, { 1, 7 }, { 7, 1 }, { 4, 3 }, { 33, 20 }, { 20, 33 } })
      for (const double range : { 5.0, 40.0, 200.0 }) {
        const oracle::LabImage lab{ oracle::random_image(width, height, 50 - range / 2,
                                                         50 + range / 2, ++seed),
                                    oracle::random_image(width, height, -range, range, ++seed),
                                    oracle::random_image(width, height, -range, range, ++seed) };
        cv::Mat weight;
        rarity(oracle::to_planes(lab), weight);
        fail_unless_at_most(oracle::difference(weight, oracle::rarity(lab, border)), 1e-5);
      }
  }
}

CHECK_TEST(test_noise_does_not_make_rare)
{
  // A plain background whose color lies on edges of L* and a* bins: noise spreads it over four bins
  // of a quarter each. Two others count half, one a quarter: R(9/16).
  const oracle::LabImage lab{ oracle::random_image(60, 40, 49.9, 50.1, 1),
                              oracle::random_image(60, 40, -0.1, 0.1, 2),
                              oracle::Image(60, 40, 10) };
  const cv::Mat weight = weight_of(lab);
  fail_unless_at_most(cv::norm(weight, cv::NORM_INF), rarity_of_share(0.5));
}

CHECK_MAIN(rarity)
