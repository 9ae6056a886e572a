// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Events: what the camera, light and noise do not explain, its map, and how strong it is.
#include "saliency/events/event_map.h"

#include "saliency/events/strength.h"
#include "saliency/events/unexplained.h"
#include "support/saliency_oracle.h"
#include "support/tolerance.h"
#include "tactile/tactile_mapping.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "support/check_tests.h"

using saliency::EventMap;
using saliency::LabImage;
using saliency::Similarity;
using saliency::Strength;
using saliency::Unexplained;

namespace {

constexpr int kWidth = 100;
constexpr int kHeight = 60;
constexpr double kNoise = 2.5 * 0.31; ///< ΔE that even parts of a picture without noise allow

/// A picture of that lightness, without color.
LabImage
picture(const std::function<double(double x, double y)> &lightness,
        cv::Size size = { kWidth, kHeight })
{
  LabImage lab;
  for (cv::Mat &plane : lab.planes)
    plane = cv::Mat(size, CV_32FC1, cv::Scalar(0));
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      lab.planes[0].at<float>(y, x) = static_cast<float>(lightness(x, y));
  return lab;
}

double
even(double, double)
{
  return 50;
}

/// Smooth, with gradients of up to about 5 a sample.
double
texture(double x, double y)
{
  return 50 + 9 * std::sin(0.31 * x + 0.07 * y) + 7 * std::sin(0.11 * x - 0.29 * y + 1)
         + 6 * std::sin(0.23 * x + 0.21 * y + 2);
}

bool
in_disc(double x, double y, double at_x, double at_y, double radius)
{
  return std::hypot(x - at_x, y - at_y) < radius;
}

double
largest(const cv::Mat &map)
{
  double most = 0;
  cv::minMaxLoc(map, nullptr, &most);
  return most;
}

} // namespace

CHECK_TEST(test_nothing_changes)
{
  Unexplained unexplained;
  for (const auto &lightness : { even, texture })
    fail_unless_near(largest(unexplained(picture(lightness), picture(lightness), Similarity{})), 0,
                     0);
}

CHECK_TEST(test_disc)
{
  // A disc of 20 ΔE appears on an even picture: inside, the difference less the noise; outside, 0.
  Unexplained unexplained;
  const LabImage now
      = picture([](double x, double y) { return in_disc(x, y, 40, 30, 8) ? 70.0 : 50.0; });
  const cv::Mat &beyond = unexplained(now, picture(even), Similarity{});
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      if (in_disc(x, y, 40, 30, 5))
        fail_unless_near(beyond.at<float>(y, x), 20 - kNoise, 1e-3);
      else if (!in_disc(x, y, 40, 30, 8))
        fail_unless_near(beyond.at<float>(y, x), 0, 0);
}

CHECK_TEST(test_slow_disc)
{
  // A disc alone has all of the picture's texture. It moves by half a sample: an edge of 20 ΔE
  // differs by 10, which its own motion must not explain.
  Unexplained unexplained;
  const auto disc_at = [](double at) {
    return picture([at](double x, double y) {
      return 50 + 20 * std::clamp(8.5 - std::hypot(x - at, y - 30), 0.0, 1.0);
    });
  };
  fail_unless_near(largest(unexplained(disc_at(40.5), disc_at(40), Similarity{})),
                   10 - 2.5 * std::hypot(0.31, 0.1 * 10), 0.8);
}

CHECK_TEST(test_exposure)
{
  // Gain and offset of the whole picture are no event, and a disc in it still is one.
  Unexplained unexplained;
  for (const auto &[gain, offset] : { std::pair{ 1.3, 0.0 }, { 0.7, 4.0 }, { 1.0, 15.0 } }) {
    const auto lit = [gain = gain, offset = offset](double x, double y) {
      return 50 + gain * (texture(x, y) - 50) + offset;
    };
    fail_unless_near(largest(unexplained(picture(lit), picture(texture), Similarity{})), 0, 0.3);
    const LabImage disc = picture([&](double x, double y) {
      return in_disc(x, y, 60, 20, 6) ? (lit(60, 20) > 50 ? 5.0 : 95.0) : lit(x, y);
    });
    fail_unless(unexplained(disc, picture(texture), Similarity{}).at<float>(20, 60) > 10);
  }
}

CHECK_TEST(test_camera)
{
  // What was at (x, y) is at (x - 3, y + 1.5) now. Known, the shift explains all, but for what
  // comes in, which is left out. Unknown by a twentieth of a sample, too.
  const LabImage then = picture(texture);
  const LabImage now = picture([](double x, double y) { return texture(x + 3, y - 1.5); });
  Unexplained unexplained;
  for (const double error : { 0.0, 0.05 }) {
    const cv::Mat &beyond = unexplained(now, then, { 1, 0, 3 + error, -1.5 });
    fail_unless_near(largest(beyond), 0, 0);
    fail_unless_at_most(static_cast<double>(unexplained.misfit()), error + 0.02);
    for (int y = 0; y < kHeight; ++y)
      fail_unless_near(beyond.at<float>(y, kWidth - 1), 0, 0);
  }
}

CHECK_TEST(test_grain)
{
  // Noise of σ 2 in both pictures, on an even and a textured one; a disc stands out of it.
  std::mt19937 generator(4);
  std::normal_distribution<double> noise(0, 2);
  const auto grainy = [&](const std::function<double(double, double)> &lightness) {
    return picture([&](double x, double y) { return lightness(x, y) + noise(generator); });
  };
  Unexplained unexplained;
  for (const auto &lightness : { even, texture }) {
    const cv::Mat &beyond = unexplained(grainy(lightness), grainy(lightness), Similarity{});
    fail_unless_at_most(cv::mean(beyond)[0], 0.05);
    const auto disc = [&](double x, double y) {
      return in_disc(x, y, 60, 20, 6) ? 95 : lightness(x, y);
    };
    fail_unless(cv::mean(unexplained(grainy(disc), grainy(lightness),
                                     Similarity{})(cv::Rect(57, 17, 7, 7)))[0]
                > 10);
  }
}

namespace {

/// The spatial saliency that EventMap is given, one octave coarser.
cv::Mat
contrast(double value = 0)
{
  return { kHeight / 2, kWidth / 2, CV_32FC1, cv::Scalar(value) };
}

} // namespace

CHECK_TEST(test_step)
{
  // A fifth of the picture becomes lighter by 20: there the energy is 20 less the noise, E. For two
  // frames the picture before is the older one of the lag. Then the onset is held, until the older
  // one of half a second is from after it, too. The map is half of that and half its mean with a
  // half-life of three frames.
  EventMap events;
  const cv::Mat still = contrast(10);
  const LabImage before = picture([](double, double) { return 40.0; });
  const LabImage after = picture([](double x, double) { return x < 20 ? 60.0 : 40.0; });
  fail_unless_near(largest(events({ .picture = before, .contrast = still })), 0, 0);
  for (int i = 0; i < 20; ++i)
    fail_unless_near(largest(events({ .picture = before, .contrast = still, .elapsed = 1 })), 0, 0);
  double energy = 0;
  double mean = 0;
  for (int i = 0; i < 25; ++i) {
    const cv::Mat &map = events({ .picture = after, .contrast = still, .elapsed = 1 });
    if (i == 0) {
      energy = events.energy();
      fail_unless_near(energy, 20 - kNoise, 0.5); // the blur takes little from the middle
    }
    const double now = i < 2 ? energy : i < 15 ? (1 - 0.8 * (i - 1) / 15) * energy : 0;
    mean = now + std::exp2(-1.0 / 3) * (mean - now);
    fail_unless_near(largest(map), (now + mean) / 2, 0.01);
    cv::Point at;
    cv::minMaxLoc(map, nullptr, nullptr, nullptr, &at);
    fail_unless(at.x < 10);
  }
  // Nothing is left of it in a new shot.
  events.reset();
  fail_unless_near(largest(events({ .picture = before, .contrast = still })), 0, 0);
}

CHECK_TEST(test_what_goes_is_no_event)
{
  // A disc jumps from the left to the right: only where it is now is an event.
  EventMap events;
  const auto disc_at = [](double at) {
    return picture([at](double x, double y) { return in_disc(x, y, at, 30, 6) ? 80.0 : 50.0; });
  };
  const auto contrast_at = [](int at) {
    cv::Mat map = contrast();
    map(cv::Rect(at / 2 - 4, 11, 8, 8)).setTo(20);
    return map;
  };
  for (int i = 0; i < 5; ++i)
    events({ .picture = disc_at(25), .contrast = contrast_at(25), .elapsed = 1 });
  const cv::Mat &map
      = events({ .picture = disc_at(75), .contrast = contrast_at(75), .elapsed = 1 });
  fail_unless(map.at<float>(15, 37) > 2);
  fail_unless_at_most(static_cast<double>(map.at<float>(15, 12)),
                      0.05 * static_cast<double>(map.at<float>(15, 37)));
}

CHECK_TEST(test_duration)
{
  // What moves is felt as long as it moves. What stands is felt for half a second, and no more a
  // second after that: a disc appears, stands for 1.5 s, moves for a second, and stands again.
  const double floor = tactile::MappingSettings::tuned().floor;
  for (const int fps : { 24, 25, 30, 50, 60 })
    for (const double lightness : { 60.0, 100.0 }) {
      EventMap events;
      for (int i = -fps; i < 5 * fps; ++i) {
        const double time = static_cast<double>(i) / fps;
        const double at = 20 + 40 * std::clamp(time - 1.5, 0.0, 1.0);
        const bool there = time >= 0;
        const LabImage now = picture(
            [&](double x, double y) { return there && in_disc(x, y, at, 30, 6) ? lightness : 50; });
        cv::Mat around = contrast();
        if (there)
          around(cv::Rect(static_cast<int>(at) / 2 - 4, 11, 8, 8)).setTo(lightness - 50);
        const bool felt
            = largest(events({ .picture = now, .contrast = around, .elapsed = 30.0 / fps }))
              > floor;
        const bool appears = time >= 0 && time < 0.45;
        const bool moves = time > 1.6 && time < 2.5; // the first way is below the noise
        if (appears || moves)
          fail_unless(felt, "%d fps, lightness %g: silent at %g s", fps, lightness, time);
        else if (time < 0 || (time > 1 && time < 1.5) || time > 3.5)
          fail_if(felt, "%d fps, lightness %g: felt at %g s", fps, lightness, time);
      }
    }
}

CHECK_TEST(test_hold_has_conditions)
{
  // A disc appears on the left and stays. Ten frames later it is held, before a camera at rest. It
  // is not while another disc moves on the right, nor while the camera pans: then only the mean is
  // left, whose half-life is three frames.
  const auto left_after = [](double pan, bool other) {
    EventMap events;
    double left = 0;
    for (int i = -20; i <= 10; ++i) {
      const double x0 = pan * i; // the camera's way
      const LabImage now = picture([&](double x, double y) {
        if (i >= 0 && in_disc(x + x0, y, 25, 30, 6))
          return 95.0;
        if (other && in_disc(x, y, 70 + 2 * (i % 8), 30, 6))
          return 95.0;
        return texture(x + x0, y);
      });
      const cv::Mat &map = events(
          { .picture = now, .contrast = contrast(10), .pose = { 1, 0, x0, 0 }, .elapsed = 1 });
      left = largest(map(cv::Rect(0, 0, kWidth / 4, kHeight / 2)));
    }
    return left;
  };
  const double held = left_after(0, false);
  fail_unless(held > 2, "%g", held);
  fail_unless_at_most(left_after(0, true), held / 2);
  // The way of two frames at .4 samples of 100, in 160ths of the width, divides the map.
  fail_unless_at_most(left_after(0.4, false) * (1 + 0.8 * 1.6), held / 2);
}

/// While the camera moves, the map is divided by 1 + its way of two frames, in 160ths of the width;
/// the energy is not. The pose is exact, so there is no misfit to divide by.
CHECK_TEST(test_way_of_the_camera)
{
  const auto after = [](double pan) {
    EventMap events;
    double peak = 0;
    for (int i = 0; i <= 12; ++i) {
      const double x0 = pan * i;
      const LabImage now = picture([&](double x, double y) {
        return in_disc(x, y, 20 + 4 * i, 30, 6) ? 95.0 : texture(x + x0, y);
      });
      cv::Mat around = contrast();
      cv::circle(around, { 10 + 2 * i, 15 }, 3, 20, cv::FILLED);
      peak = largest(
          events({ .picture = now, .contrast = around, .pose = { 1, 0, x0, 0 }, .elapsed = 1 }));
    }
    return std::pair(peak, events.energy());
  };
  const auto [still, energy] = after(0);
  fail_unless(still > 5, "%g", still);
  for (const double pan : { 0.1, 0.3, 0.6, 1.2 }) {
    const auto [moved, moved_energy] = after(pan);
    const double way = 2 * pan * 160 / kWidth;
    fail_unless_near(moved * (1 + way) / still, 1, 0.15);
    fail_unless_near(moved_energy / energy, 1, 0.15);
  }
}

namespace {

/// The map's maximum within the middle half of the rows, and the last second of two, while a
/// pattern scrolls up by a quarter of a sample a frame before `ground`. The pattern returns whether
/// its white covers (x, y).
double
scroll(const std::function<double(double x, double y)> &ground,
       const std::function<bool(double x, double y)> &white)
{
  EventMap events;
  double most = 0;
  for (int i = 0; i < 60; ++i) {
    const auto now = [&](double x, double y) {
      // A quarter of a sample is seen as a gray.
      double share = 0;
      for (const double part : { 0.125, 0.375, 0.625, 0.875 })
        share += white(x, y + 0.25 * i + part) ? 0.25 : 0;
      return ground(x, y) + share * (95 - ground(x, y));
    };
    cv::Mat around = contrast();
    for (int y = 0; y < around.rows; ++y)
      for (int x = 0; x < around.cols; ++x)
        around.at<float>(y, x) = now(2 * x, 2 * y) > ground(2 * x, 2 * y) + 6 ? 20 : 0;
    const cv::Mat &map = events({ .picture = picture(now), .contrast = around, .elapsed = 1 });
    if (i >= 30)
      most = std::max(most, largest(map.rowRange(map.rows / 4, map.rows - map.rows / 4)));
  }
  return most;
}

} // namespace

/// Lines of words that scroll change four times as much as things of the same contrast and speed, a
/// bar over many lines and discs of 5 and 7 % of the width. Only the things are felt.
CHECK_TEST(test_text_and_things)
{
  const double floor = tactile::MappingSettings::tuned().floor;
  for (const auto &ground : { even, texture }) {
    const double text = scroll(ground, [](double x, double y) {
      return x > 30 && x < 60 && std::fmod(x, 8) < 6 && std::fmod(y, 4) < 2;
    });
    const double bar
        = scroll(ground, [](double x, double y) { return x > 30 && x < 60 && y > 40 && y < 60; });
    fail_unless(bar > floor, "bar %g", bar);
    for (const double radius : { 3.0, 4.0 }) {
      const double disc
          = scroll(ground, [&](double x, double y) { return in_disc(x, y, 45, 38, radius); });
      fail_unless(disc > floor, "disc of %g: %g", radius, disc);
    }
    fail_unless_at_most(text / floor, 0.1);
  }
}

/// A change of color has no sign, whatever lightness does a little: stripes of two colors that
/// appear are as strong as one color. Stripes of lightness are not.
CHECK_TEST(test_colors_have_no_sign)
{
  const auto after = [](bool stripes, int plane, float lightness) {
    EventMap events;
    events({ .picture = picture(even), .contrast = contrast(10) });
    LabImage now = picture(even);
    for (int y = 15; y < 30; ++y)
      for (int x = 30; x < 45; ++x) {
        const float sign = stripes && x % 2 == 1 ? -1 : 1;
        now.planes[0].at<float>(y, x) += sign * lightness;
        now.planes[static_cast<std::size_t>(plane)].at<float>(y, x) += sign * 40;
      }
    return largest(events({ .picture = now, .contrast = contrast(10), .elapsed = 1 }));
  };
  for (const int color : { 1, 2 })
    fail_unless_near(after(true, color, 0.5F) / after(false, color, 0.5F), 1, 0.05);
  fail_unless_at_most(after(true, 0, 0) / after(false, 0, 0), 0.1);
}

CHECK_TEST(test_rebase)
{
  // Another frame of reference gives the same maps.
  EventMap one;
  EventMap other;
  const Similarity view{ 1.2, 0.3, 40, -7 };
  double most = 0;
  for (int i = 0; i < 20; ++i) {
    const auto ball = [i](double x, double y) {
      return in_disc(x, y, 20 + 3 * i, 30, 6) ? 90.0 : texture(x + 0.4 * i, y);
    };
    const LabImage now = picture(ball);
    const cv::Mat around = contrast(5);
    const Similarity pose{ 1, 0, 0.4 * i, 0 };
    const cv::Mat &map = one({ .picture = now, .contrast = around, .pose = pose, .elapsed = 1 });
    if (i == 10)
      other.rebase(view);
    const cv::Mat &same = other(
        { .picture = now, .contrast = around, .pose = i < 10 ? pose : view * pose, .elapsed = 1 });
    fail_unless_at_most(cv::norm(map, same, cv::NORM_INF), 1e-3);
    most = std::max(most, largest(map));
  }
  fail_unless(most > 2);
}

CHECK_TEST(test_strength)
{
  // In a film that is usual, the usual is 1, and strengths are as energies.
  fail_unless_near(Strength().follow(Strength::kUsual, 0), 1, 1e-12);
  fail_unless_near(Strength().follow(Strength::kUsual / 30, 0), 1.0 / 30, 1e-12);
  fail_unless_near(Strength().follow(0, 0), 0, 0);
  // Five minutes of a film with as many weak events of 2 as strong ones of 6 ΔE: the quantile is
  // between 6 and a step beyond it, and the strong ones are three times as strong.
  Strength strength;
  double weak = 0;
  double strong = 0;
  for (int i = 0; i < 9000; ++i) {
    strong = strength.follow(6, 1);
    weak = strength.follow(2, 1);
  }
  fail_unless_near(strong, std::sqrt(6 / Strength::kUsual), 0.02);
  fail_unless_near(weak / strong, 1.0 / 3, 0.02);
  // Silence tells nothing of the film.
  for (int i = 0; i < 9000; ++i)
    strength.follow(0, 1);
  fail_unless_near(strength.follow(6, 0), strong, 0.02);
  strength.reset();
  fail_unless_near(strength.follow(Strength::kUsual, 0), 1, 1e-12);
}

CHECK_MAIN(events)
