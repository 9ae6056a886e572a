// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/shot_cut.h"

#include "support/saliency_oracle.h"
#include "support/tolerance.h"

#include "support/check_tests.h"

using saliency::LabImage;
using saliency::Profile;
using saliency::ShotCut;

namespace {

Profile
profile(double share, double contrast)
{
  Profile p;
  p.cut_share = share;
  p.cut_contrast = contrast;
  return p;
}

LabImage
even(cv::Size size, cv::Vec3f color)
{
  LabImage image;
  for (std::size_t c = 0; c < 3; ++c)
    image.planes[c] = cv::Mat(size, CV_32FC1, cv::Scalar(color[static_cast<int>(c)]));
  return image;
}

/// A picture of 10×8 pixels with the color on the first `count`, black elsewhere.
LabImage
picture(cv::Vec3f color, int count = 80)
{
  LabImage image = even({ 10, 8 }, {});
  for (std::size_t c = 0; c < 3; ++c)
    std::fill_n(image.planes[c].ptr<float>(), count, color[static_cast<int>(c)]);
  return image;
}

} // namespace

CHECK_TEST(test_share)
{
  // More than half of 80 pixels: 41 make a cut, 40 do not. The same on the way back.
  ShotCut cut(profile(0.5, 6));
  fail_if(cut(picture({})));
  for (const int count : { 39, 40, 41, 80 }) {
    ck_assert_int_eq(cut(picture({ 50, 0, 0 }, count)), count > 40);
    ck_assert_int_eq(cut(picture({})), count > 40);
  }
}

CHECK_TEST(test_contrast)
{
  // (2, 3, 6) is 7 ΔE from black, whatever the signs.
  for (const auto &color : { cv::Vec3f(2, 3, 6), cv::Vec3f(2, -6, 3), cv::Vec3f(6, 2, -3) })
    for (const double contrast : { 6.999, 7.001 }) {
      ShotCut cut(profile(0.5, contrast));
      fail_if(cut(picture({})));
      ck_assert_int_eq(cut(picture(color)), contrast < 7);
    }
}

CHECK_TEST(test_slow_change)
{
  // A fade over 20 frames is no cut, although its last picture differs from its first: each frame
  // is compared with its predecessor.
  ShotCut cut(profile(0.5, 6));
  for (int i = 0; i <= 20; ++i)
    fail_if(cut(picture({ 5.0F * static_cast<float>(i), 0, 0 })));
  fail_unless(cut(picture({})));
}

CHECK_TEST(test_first_frame)
{
  ShotCut cut(profile(0, 6));
  const LabImage white = picture({ 100, 0, 0 });
  const LabImage other = even({ 5, 3 }, {});
  fail_if(cut(white));
  fail_unless(cut(picture({})));
  cut.reset();
  fail_if(cut(white));
  fail_if(cut(other)); // another size
  fail_if(cut(other));
  fail_if(cut(white));
  fail_unless(cut(picture({}, 80)));
  // A share of 1 cannot be exceeded.
  ShotCut never(profile(1, 6));
  fail_if(never(white));
  fail_if(never(picture({})));
}

CHECK_TEST(test_copies)
{
  // The caller may reuse the frame's memory.
  ShotCut cut(profile(0.5, 6));
  LabImage frame = picture({});
  fail_if(cut(frame));
  frame.planes[0].setTo(100);
  fail_unless(cut(frame));
}

CHECK_TEST(test_few_samples)
{
  // 63 samples are too few to decide, 64 are enough.
  for (const cv::Size size : { cv::Size(9, 7), cv::Size(8, 8), cv::Size(1, 1) }) {
    ShotCut cut(profile(0.5, 6));
    fail_if(cut(even(size, {})));
    ck_assert_int_eq(cut(even(size, { 100, 0, 0 })), size.area() == 64);
  }
}

CHECK_MAIN(shot_cut)
