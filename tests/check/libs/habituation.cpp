// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What is no event although it differs from the past: what stands still (Habituation), what goes on
// all the time (NoiseFloor), and gradual transitions (GradualTransition).
#include "saliency/habituation.h"

#include "saliency/gradual_transition.h"
#include "saliency/noise_floor.h"
#include "support/saliency_oracle.h"
#include "support/tolerance.h"

#include <algorithm>
#include <cmath>
#include <tuple>

using oracle::Image;
using saliency::GradualTransition;
using saliency::Habituation;
using saliency::NoiseFloor;
using saliency::Profile;

namespace {

Profile
habituating()
{
  Profile profile;
  profile.habituation_after = 15;
  profile.habituation_contrast = 0.6;
  profile.habituation_share = 0.2;
  return profile;
}

/// The share of the sample, also if none is returned.
double
share_at(const cv::Mat &shares, int x)
{
  return shares.empty() ? 0 : static_cast<double>(shares.at<float>(0, x));
}

/// For how many frames of `now`, after ten of `before`, a sample has no share.
int
frames_until_familiar(double before, double now)
{
  Habituation habituation(habituating());
  for (int i = 0; i < 10; ++i)
    habituation.settled(oracle::to_mat(Image(1, 1, before)), 1);
  const cv::Mat map = oracle::to_mat(Image(1, 1, now));
  int frames = 0;
  while (frames < 100 && !(share_at(habituation.settled(map, 1), 0) > 0))
    ++frames;
  return frames;
}

constexpr int kWidth = 24;
constexpr int kHeight = 18;

oracle::LabImage
random_picture(unsigned seed)
{
  return { oracle::random_image(kWidth, kHeight, 0, 100, 3 * seed),
           oracle::random_image(kWidth, kHeight, -40, 40, 3 * seed + 1),
           oracle::random_image(kWidth, kHeight, -40, 40, 3 * seed + 2) };
}

oracle::LabImage
mixed(const oracle::LabImage &from, const oracle::LabImage &to, double share)
{
  oracle::LabImage mix = from;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < mix[c].values.size(); ++i)
      mix[c].values[i] += share * (to[c].values[i] - mix[c].values[i]);
  return mix;
}

constexpr int kDissolves = 20; ///< its last frame of the first picture
constexpr int kDissolve = 24;  ///< frames

oracle::LabImage
dissolve(int frame)
{
  return mixed(random_picture(1), random_picture(2),
               std::clamp((frame - kDissolves) / static_cast<double>(kDissolve), 0.0, 1.0));
}

} // namespace

GST_START_TEST(test_fading)
{
  // What is left of the past falls from 1 to 0 linearly, in the same time at all frame rates.
  const cv::Mat map = oracle::to_mat(Image(2, 1, 7));
  for (const double step : { 30 / 24.0, 1.0, 0.5 }) {
    Habituation habituation(habituating());
    double left = 1;
    for (int i = 0; i * step < 60; ++i) {
      const cv::Mat &shares = habituation.settled(map, step);
      left *= 1 - share_at(shares, 0);
      fail_unless_near(left, std::clamp((15 + Habituation::kFading - i * step) / 9, 0.0, 1.0),
                       1e-5);
      if (i * step >= 15 + Habituation::kFading)
        fail_unless_near(left, 0, 0);
    }
  }
}
GST_END_TEST;

GST_START_TEST(test_change_restarts)
{
  // Ten frames of one value, nine of them after the first. Of the next value the first frame is the
  // tenth at rest, or the one at which time starts again.
  for (const auto &[before, now, restarts] : { std::tuple{ 1.0, 1.55, false },
                                               { 1.0, 1.65, true },
                                               { 1.0, 0.35, true },
                                               { 1.0, 0.45, false },
                                               { 20.0, 23.9, false },
                                               { 20.0, 24.1, true },
                                               { 20.0, 16.1, false },
                                               { 20.0, 15.9, true } }) {
    const int frames = frames_until_familiar(before, now);
    fail_unless(frames == (restarts ? 16 : 6), "%g, then %g: %d", before, now, frames);
  }
}
GST_END_TEST;

GST_START_TEST(test_slow_drift_restarts)
{
  // The change counts from the first value, not from the last frame's.
  Habituation habituation(habituating());
  for (int i = 0; i < 30; ++i)
    fail_unless_near(share_at(habituation.settled(oracle::to_mat(Image(1, 1, 0.1 * i)), 2), 0), 0,
                     0);
}
GST_END_TEST;

GST_START_TEST(test_habituation_reset)
{
  Habituation habituation(habituating());
  const cv::Mat map = oracle::to_mat(Image(3, 2, 7));
  for (int i = 0; i < 18; ++i)
    habituation.settled(map, 1);
  fail_unless(share_at(habituation.settled(map, 1), 0) > 0);
  habituation.reset();
  for (int i = 0; i <= 15; ++i)
    fail_unless_near(share_at(habituation.settled(map, 1), 0), 0, 0);
  fail_unless(share_at(habituation.settled(map, 1), 0) > 0);
  // So does a map of another size.
  const cv::Mat larger = oracle::to_mat(Image(4, 4, 7));
  for (int i = 0; i <= 15; ++i)
    fail_unless_near(share_at(habituation.settled(larger, 1), 0), 0, 0);
}
GST_END_TEST;

GST_START_TEST(test_dissolve)
{
  GradualTransition transition;
  for (int i = 0; i < 80; ++i) {
    const cv::Mat &mask = transition(oracle::to_planes(dissolve(i)), 1);
    const int since = i - kDissolves;
    // Both differences need a part of it. At the end I(t) − I(t − 4) shrinks for three frames more,
    // and the result holds for six.
    if (since <= 0 || since > kDissolve + 3 + 6)
      fail_unless(mask.empty(), "%d", since);
    if (since >= 9 && since <= kDissolve + 3 + 6)
      fail_unless(!mask.empty() && cv::countNonZero(mask == 1) == kWidth * kHeight, "%d", since);
  }
}
GST_END_TEST;

GST_START_TEST(test_slow_dissolve)
{
  // Within 4 frames most samples change by about ΔE 1, hardly more than the noise.
  const auto from = random_picture(1);
  const auto to = mixed(from, random_picture(2), 0.25);
  GradualTransition transition;
  for (int i = 0; i < 50; ++i) {
    auto picture = mixed(from, to, std::max(0, i - 10) / 60.0);
    for (std::size_t c = 0; c < 3; ++c) {
      const Image noise
          = oracle::random_image(kWidth, kHeight, -0.2, 0.2,
                                 100 + 3 * static_cast<unsigned>(i) + static_cast<unsigned>(c));
      for (std::size_t j = 0; j < noise.values.size(); ++j)
        picture[c].values[j] += noise.values[j];
    }
    const bool found = !transition(oracle::to_planes(picture), 1).empty();
    if (i < 10 || i >= 10 + 8)
      fail_unless(found == (i > 10), "frame %d", i);
  }
}
GST_END_TEST;

GST_START_TEST(test_event_in_dissolve)
{
  // A spot jumps by 30 ΔE.
  GradualTransition transition;
  for (int i = 0; i < 40; ++i) {
    const int since = i - kDissolves;
    auto picture = dissolve(i);
    if (since >= 14)
      for (int y = 6; y < 9; ++y)
        for (int x = 10; x < 13; ++x)
          picture[0](x, y) += 30;
    const cv::Mat &mask = transition(oracle::to_planes(picture), 1);
    if (since < 14 || since >= 18)
      continue;
    fail_if(mask.empty());
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const bool spot = x >= 10 && x < 13 && y >= 6 && y < 9;
        fail_unless((mask.at<float>(y, x) > 0) != spot, "frame %d: %d, %d", since, x, y);
      }
  }
}
GST_END_TEST;

GST_START_TEST(test_no_transition)
{
  // A large textured object that moves over a still picture, noise, and a cut.
  const auto still = random_picture(1);
  const auto object = random_picture(2);
  for (const int kind : { 0, 1, 2 }) {
    GradualTransition transition;
    for (int i = 0; i < 40; ++i) {
      auto picture = kind == 2 && i >= 20 ? object : still;
      for (std::size_t c = 0; c < 3; ++c) {
        const Image noise = oracle::random_image(
            kWidth, kHeight, -3, 3, 100 + 3 * static_cast<unsigned>(i) + static_cast<unsigned>(c));
        for (int y = 0; y < kHeight; ++y)
          for (int x = 0; x < kWidth; ++x)
            if (kind == 1)
              picture[c](x, y) += noise(x, y);
            else if (kind == 0 && y < 14 && x >= i - 10 && x < i)
              picture[c](x, y) = object[c](x - i + 10, y);
      }
      fail_unless(transition(oracle::to_planes(picture), 1).empty(), "%d, frame %d", kind, i);
    }
  }
}
GST_END_TEST;

GST_START_TEST(test_transition_reset)
{
  GradualTransition transition;
  for (int i = 0; i < kDissolves + 12; ++i)
    transition(oracle::to_planes(dissolve(i)), 1);
  fail_if(transition(oracle::to_planes(dissolve(kDissolves + 12)), 1).empty());
  transition.reset();
  for (int i = 13; i < 13 + 6; ++i) // not enough is known of the past
    fail_unless(transition(oracle::to_planes(dissolve(kDissolves + i)), 1).empty());
}
GST_END_TEST;

GST_START_TEST(test_noise_floor)
{
  // Constant activity. Smoothed, it rises as 1 − e^(−t/4), so the least of a stretch is its first,
  // and the least but one of the stretches is the second's.
  constexpr double kValue = 3;
  constexpr double kGain = 0.5;
  for (const double step : { 1.0, 0.5, 1.25 }) {
    NoiseFloor floor;
    for (int i = 0; i * step < 400; ++i) {
      cv::Mat map = oracle::to_mat(Image(10, 6, kValue));
      floor.subtract(map, step, kGain);
      const int stretch = static_cast<int>(i * step / 30);
      const double first = (std::max(0, stretch - 6) + 1) * 30 + step;
      const double expected
          = stretch < 4 ? kValue : kValue - kGain * kValue * (1 - std::exp(-first / 4));
      fail_unless_at_most(oracle::difference(map, Image(10, 6, expected)), 1e-4);
    }
  }
}
GST_END_TEST;

GST_START_TEST(test_pause)
{
  // What paused in two of the last six stretches and this one is not lowered: only by what
  // smoothing leaves of it. A pause within one stretch does not count.
  NoiseFloor floor;
  for (int i = 0; i < 520; ++i) {
    const bool pauses = (i >= 200 && i < 250) || (i >= 455 && i < 470);
    const double value = pauses ? 0 : 3;
    cv::Mat map = oracle::to_mat(Image(10, 6, value));
    floor.subtract(map, 1, 4);
    if (i >= 180 && i < 200)
      fail_unless_near(map.at<float>(0), 0, 0);
    if (i >= 250 && i < 420)
      fail_unless_near(map.at<float>(0), 3, 4 * 3 * std::exp(-40 / 4.0) + 1e-4);
    if ((i >= 420 && i < 455) || i >= 490)
      fail_unless_near(map.at<float>(0), 0, 0);
  }
}
GST_END_TEST;

GST_START_TEST(test_strong_activity)
{
  // An event of 20 above constant activity of that strength.
  for (const auto &[activity, lowered] : { std::pair{ 0.5, 3.5 },
                                           { 0.9, 6.3 },
                                           { 3.0, 7.0 },
                                           { 4.0, 3.5 },
                                           { 4.25, 1.75 },
                                           { 6.0, 0.0 } }) {
    NoiseFloor floor;
    for (int i = 0; i < 300; ++i) {
      cv::Mat map = oracle::to_mat(Image(10, 6, activity));
      floor.subtract(map, 1, 7);
    }
    cv::Mat map = oracle::to_mat(Image(10, 6, activity));
    map.at<float>(0) = 20;
    floor.subtract(map, 1, 7);
    fail_unless_near(map.at<float>(0), 20 - lowered, 1e-3);
    fail_unless_near(map.at<float>(9), std::max(0.0, activity - lowered), 1e-3);
  }
}
GST_END_TEST;

GST_START_TEST(test_reach_and_reset)
{
  // Activity at (8, 6) lowers an event up to 5 of 20 samples away.
  NoiseFloor floor;
  const auto lowered = [&floor](double elsewhere) {
    Image image(20, 12, elsewhere);
    image(8, 6) = 3;
    cv::Mat map = oracle::to_mat(image);
    floor.subtract(map, 1, 1);
    return map;
  };
  for (int i = 0; i < 300; ++i)
    lowered(0);
  const cv::Mat map = lowered(3);
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 20; ++x)
      fail_unless_near(map.at<float>(y, x), std::max(std::abs(x - 8), std::abs(y - 6)) <= 5 ? 0 : 3,
                       1e-3);
  floor.reset();
  for (int i = 0; i < 120; ++i)
    fail_unless_near(lowered(3).at<float>(6, 8), 3, 0);
  fail_unless(lowered(3).at<float>(6, 8) < 3);
}
GST_END_TEST;

static Suite *
habituation_suite(void)
{
  Suite *suite = suite_create("habituation");
  TCase *tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_test(tc, test_fading);
  tcase_add_test(tc, test_change_restarts);
  tcase_add_test(tc, test_slow_drift_restarts);
  tcase_add_test(tc, test_habituation_reset);
  tcase_add_test(tc, test_dissolve);
  tcase_add_test(tc, test_slow_dissolve);
  tcase_add_test(tc, test_event_in_dissolve);
  tcase_add_test(tc, test_no_transition);
  tcase_add_test(tc, test_transition_reset);
  tcase_add_test(tc, test_noise_floor);
  tcase_add_test(tc, test_pause);
  tcase_add_test(tc, test_strong_activity);
  tcase_add_test(tc, test_reach_and_reset);
  return suite;
}

GST_CHECK_MAIN(habituation);
