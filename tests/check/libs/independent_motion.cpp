// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/independent_motion.h"

#include "support/saliency_oracle.h"
#include "support/tolerance.h"

#include <cmath>
#include <functional>

using oracle::Image;
using saliency::IndependentMotion;
using saliency::Similarity;

namespace {

constexpr int kWidth = 100;
constexpr int kHeight = 75;
/// The gate is open at first, for 7.5 ln 4 frames.
constexpr int kOpening = 11;

/// A smooth texture at any place.
oracle::Lab
world(double x, double y)
{
  return { 50 + 14 * std::sin(0.41 * x + 0.13 * y) + 14 * std::cos(0.37 * y - 0.19 * x + 1)
               + 8 * std::sin(0.23 * x - 0.29 * y),
           10 * std::sin(0.21 * x + 0.31 * y), 10 * std::cos(0.27 * x - 0.17 * y) };
}

using Scene = std::function<oracle::Lab(int x, int y)>; ///< by sample of the frame

saliency::LabImage
picture(const Scene &scene)
{
  oracle::LabImage image{ Image(kWidth, kHeight), Image(kWidth, kHeight), Image(kWidth, kHeight) };
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (std::size_t c = 0; c < 3; ++c)
        image[c](x, y) = scene(x, y)[c];
  return oracle::to_planes(image);
}

/// A camera that travels, zooms and rolls.
Similarity
camera(int frame)
{
  return { 1 + 0.001 * frame, 0.0007 * frame, 1.3 * frame, -0.4 * frame };
}

oracle::Lab
seen(const Similarity &pose, double x, double y)
{
  return world(pose.x(x, y), pose.y(x, y));
}

} // namespace

GST_START_TEST(test_camera_only)
{
  for (const double step : { 1.0, 0.5 }) {
    IndependentMotion independent;
    for (int i = 0; i * step < 40; ++i) {
      const Similarity pose = camera(i);
      const cv::Mat &gate
          = independent(picture([&](int x, int y) { return seen(pose, x, y); }), pose, step, 1);
      fail_unless(gate.size() == cv::Size(kWidth / 2, (kHeight + 1) / 2));
      fail_unless(cv::checkRange(gate, true, nullptr, 0, 1.0001));
      if (i * step >= kOpening)
        fail_unless(cv::countNonZero(gate) == 0, "frame %d", i);
    }
  }
}
GST_END_TEST;

GST_START_TEST(test_parallax)
{
  // A ramp of depth: what is lower moves faster, by 1 sample a frame. No similarity explains it.
  IndependentMotion independent;
  for (int i = 0; i < 60; ++i) {
    const Similarity pose{ 1, 0, 1.2 * i, 0 };
    const cv::Mat &gate = independent(
        picture([&](int x, int y) { return seen(pose, x + i * (y - 37.0) / kHeight, y); }), pose, 1,
        1);
    if (i >= kOpening)
      fail_unless_at_most(cv::countNonZero(gate > 0.1) / static_cast<double>(gate.total()), 0.01);
  }
}
GST_END_TEST;

GST_START_TEST(test_object)
{
  // A square that moves by 1 sample a frame, while what is behind it moves by 1.2 the other way.
  IndependentMotion independent;
  constexpr int kTop = 30;
  constexpr int kSide = 10;
  for (int i = 0; i < 60; ++i) {
    const Similarity pose{ 1, 0, 1.2 * i, 0 };
    const int left = 15 + i;
    const cv::Mat &gate
        = independent(picture([&](int x, int y) {
                        return x >= left && x < left + kSide && y >= kTop && y < kTop + kSide
                                   ? world(300.0 + 2 * (x - left), 200.0 + 2 * y)
                                   : seen(pose, x, y);
                      }),
                      pose, 1, 1);
    if (i < kOpening)
      continue;
    fail_unless(gate.at<float>((kTop + kSide / 2) / 2, (left + kSide / 2) / 2) > 0.9F, "frame %d",
                i);
    for (int y = 0; y < gate.rows; ++y)
      for (int x = 0; x < gate.cols; ++x)
        if (2 * y < kTop - 16 || 2 * y > kTop + kSide + 16 || 2 * x > left + kSide + 16)
          fail_unless_near(gate.at<float>(y, x), 0, 0);
  }
}
GST_END_TEST;

GST_START_TEST(test_appearance)
{
  // A square of another lightness, or of another color alone, appears and moves with what is around
  // it.
  constexpr int kAppears = 25;
  for (std::size_t c = 0; c < 3; ++c) {
    IndependentMotion independent;
    for (int i = 0; i < kAppears + 20; ++i) {
      const Similarity pose{ 1, 0, 0.5 * i, 0 };
      const auto in_square = [&](int x, int y) {
        return std::abs(pose.x(x, y) - 70) <= 5 && std::abs(y - 40) <= 5;
      };
      const cv::Mat &gate = independent(picture([&](int x, int y) {
                                          auto lab = seen(pose, x, y);
                                          if (i >= kAppears && in_square(x, y))
                                            lab[c] += 25;
                                          return lab;
                                        }),
                                        pose, 1, 1);
      if (i < kOpening)
        continue;
      const int x = static_cast<int>((70 - 0.5 * i) / 2);
      if (i >= kAppears && i < kAppears + 5)
        fail_unless(gate.at<float>(20, x) > 0.9F, "component %zu, frame %d", c, i);
      if (i < kAppears)
        fail_unless(cv::countNonZero(gate) == 0, "component %zu, frame %d", c, i);
      fail_unless(cv::countNonZero(gate.rowRange(0, 10)) == 0);
      fail_unless(cv::countNonZero(gate.colRange(0, x - 10)) == 0 || i >= kAppears + 10);
    }
  }
}
GST_END_TEST;

GST_START_TEST(test_closes)
{
  // A soft light that appears and moves with what is around it is known with the next key frame, 5
  // frames later at most. The gate closes 7.5 ln 40 frames after the last novelty, at most.
  constexpr int kAppears = 23;
  constexpr int kCloses = kAppears + 5 + 28;
  IndependentMotion independent;
  for (int i = 0; i < kCloses + 10; ++i) {
    const Similarity pose{ 1, 0, 0.5 * i, 0 };
    const cv::Mat &gate
        = independent(picture([&](int x, int y) {
                        auto lab = seen(pose, x, y);
                        if (i >= kAppears)
                          lab[0] += 30 * std::exp(-std::hypot(pose.x(x, y) - 70, y - 40) / 4);
                        return lab;
                      }),
                      pose, 1, 1);
    const int open = cv::countNonZero(gate);
    if (i >= kAppears && i < kAppears + 10)
      fail_unless(open > 0, "closed in frame %d", i);
    if (i >= kCloses)
      fail_unless(open == 0, "open in frame %d", i);
  }
}
GST_END_TEST;

GST_START_TEST(test_reset)
{
  for (const int octaves : { 0, 1, 2 }) {
    IndependentMotion independent;
    const auto still = picture([](int x, int y) { return world(x, y); });
    for (int i = 0; i < 20; ++i)
      independent(still, {}, 1, octaves);
    fail_unless(cv::countNonZero(independent(still, {}, 1, octaves)) == 0);
    independent.reset();
    for (int i = 0; i <= kOpening; ++i) {
      // 0.6 e^(−t/7.5), from 0.2 to 0.6.
      const double open = (0.6 * std::exp(-(i + 1) / 7.5) - 0.2) / 0.4;
      const cv::Mat &gate = independent(still, {}, 1, octaves);
      fail_unless_near(gate.at<float>(0), std::max(0.0, open), 1e-4);
      fail_unless_near(gate.at<float>(gate.rows - 1, gate.cols - 1), std::max(0.0, open), 1e-4);
    }
  }
}
GST_END_TEST;

static Suite *
independent_motion_suite(void)
{
  Suite *suite = suite_create("independent_motion");
  TCase *tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_test(tc, test_camera_only);
  tcase_add_test(tc, test_parallax);
  tcase_add_test(tc, test_object);
  tcase_add_test(tc, test_appearance);
  tcase_add_test(tc, test_closes);
  tcase_add_test(tc, test_reset);
  return suite;
}

GST_CHECK_MAIN(independent_motion);
