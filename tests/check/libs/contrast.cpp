// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/contrast.h"

#include "saliency/pyramid.h"
#include "saliency_oracle.h"
#include "tolerance.h"

namespace {

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

} // namespace

GST_START_TEST(test_brute_force)
{
  unsigned seed = 0;
  for (const double weight : { 1.0, 2.0, 0.5, 0.0 }) {
    saliency::Contrast contrast(weight); // one for all sizes: buffers are reused
    for (const cv::Size size :
         { cv::Size(1, 1), cv::Size(1, 9), cv::Size(20, 1), cv::Size(31, 17) })
      for (int octaves = 0; octaves <= 5; ++octaves) {
        const auto center = random_lab(size, seed += 3);
        const auto surround = random_lab(saliency::level_size(size, octaves), seed += 3);
        cv::Mat map;
        contrast(oracle::to_mat(center), oracle::to_mat(surround), octaves, map);
        fail_unless_at_most(
            oracle::difference(map, oracle::contrast(center, surround, octaves, weight)), 1e-3);
      }
  }
}
GST_END_TEST;

GST_START_TEST(test_closed_form)
{
  // (3, 4, 12) apart: ΔE = 13, and with chroma counted twice √(9 + 4·160).
  const auto center = oracle::to_mat(uniform_lab(8, 8, { 53, -6, 22 }));
  const auto surround = oracle::to_mat(uniform_lab(2, 2, { 50, -10, 10 }));
  cv::Mat map;
  saliency::Contrast(1)(center, surround, 2, map);
  fail_unless_at_most(oracle::difference(map, oracle::Image(8, 8, 13)), 1e-5);
  saliency::Contrast(2)(center, surround, 2, map);
  fail_unless_at_most(oracle::difference(map, oracle::Image(8, 8, std::sqrt(649.0))), 1e-5);
}
GST_END_TEST;

GST_START_TEST(test_ramp_has_no_contrast)
{
  // Centre and surround of a linear ramp agree wherever both lie where they say they lie;
  // half-pixel centres would leave a contrast of (2² - 1)/2 samples' worth of slope.
  oracle::LabImage fine = uniform_lab(65, 65, { 0, 0, 0 });
  oracle::LabImage coarse = uniform_lab(17, 17, { 0, 0, 0 });
  for (int y = 0; y < 65; ++y)
    for (int x = 0; x < 65; ++x)
      fine[0](x, y) = x + 0.5 * y;
  for (int y = 0; y < 17; ++y)
    for (int x = 0; x < 17; ++x)
      coarse[0](x, y) = 4 * x + 2.0 * y;
  cv::Mat map;
  saliency::Contrast(1)(oracle::to_mat(fine), oracle::to_mat(coarse), 2, map);
  fail_unless_at_most(oracle::difference(map, oracle::Image(65, 65, 0)), 1e-5);
}
GST_END_TEST;

static Suite *
contrast_suite(void)
{
  Suite *suite = suite_create("contrast");
  TCase *tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_test(tc, test_brute_force);
  tcase_add_test(tc, test_closed_form);
  tcase_add_test(tc, test_ramp_has_no_contrast);
  return suite;
}

GST_CHECK_MAIN(contrast);
