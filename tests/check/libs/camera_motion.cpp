// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/camera_motion.h"

#include "support/saliency_oracle.h"
#include "support/tolerance.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "support/check_tests.h"

using saliency::CameraMotion;
using saliency::Similarity;

namespace {

const cv::Size kSize(110, 62);

/// An endless surface in closed form, L* from 20 to 80: waves of 5 to 40 samples in all directions.
double
surface(double x, double y)
{
  double sum = 50;
  for (int i = 0; i < 6; ++i) {
    const double length = 5 * std::pow(8.0, i / 5.0);
    const double angle = 2.4 * i;
    sum += 8 * std::sin(2 * M_PI / length * (x * std::cos(angle) + y * std::sin(angle)) + i * i);
  }
  return std::clamp(sum, 20.0, 80.0);
}

cv::Mat
frame(cv::Size size, const std::function<double(int, int)> &lightness)
{
  cv::Mat image(size, CV_32FC1);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      image.at<float>(y, x) = static_cast<float>(lightness(x, y));
  return image;
}

/// The surface as seen from a pose.
cv::Mat
seen_from(const Similarity &pose, cv::Size size = kSize)
{
  return frame(size, [&](int x, int y) { return surface(pose.x(x, y), pose.y(x, y)); });
}

void
add_noise(cv::Mat &image, double deviation, unsigned seed)
{
  if (deviation <= 0) // std::normal_distribution expects more
    return;
  std::mt19937 generator(seed);
  std::normal_distribution<float> noise(0, static_cast<float>(deviation));
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      image.at<float>(y, x) += noise(generator);
}

/// Rotation and scale about the center of the picture, then a shift.
Similarity
about_middle(double scale, double angle, double dx, double dy)
{
  const double cx = kSize.width / 2.0;
  const double cy = kSize.height / 2.0;
  const double a = scale * std::cos(angle);
  const double b = scale * std::sin(angle);
  return { a, b, cx - a * cx + b * cy + dx, cy - b * cx - a * cy + dy };
}

/// The largest distance, in samples, between a corner's places in two poses.
double
apart(const Similarity &p, const Similarity &q, cv::Size size = kSize)
{
  double largest = 0;
  for (const int x : { 0, size.width - 1 })
    for (const int y : { 0, size.height - 1 }) {
      const double d = std::hypot(p.x(x, y) - q.x(x, y), p.y(x, y) - q.y(x, y));
      if (!std::isfinite(d))
        return INFINITY;
      largest = std::max(largest, d);
    }
  return largest;
}

} // namespace

CHECK_TEST(test_follows)
{
  // A constant step per frame. The accumulated pose may be off by half a sample and 1 % of the
  // distance that a corner has moved.
  const struct
  {
    const char *name;
    Similarity step;
    int frames;
  } cases[] = {
    { "pan", about_middle(1, 0, 0.7, 0), 90 },
    { "tilt back", about_middle(1, 0, 0, -0.4), 90 },
    { "slow pan", about_middle(1, 0, 0.08, 0.03), 120 },
    { "fast pan", about_middle(1, 0, -4, 1), 60 },
    { "zoom in", about_middle(0.995, 0, 0, 0), 90 },
    { "zoom out", about_middle(1.006, 0, 0, 0), 60 },
    { "roll", about_middle(1, 0.01, 0, 0), 90 },
    { "all", about_middle(1.003, -0.004, 0.5, -0.3), 90 },
  };
  for (const auto &c : cases)
    for (const double noise : { 0.0, 1.0 }) {
      CameraMotion camera;
      Similarity pose;
      double way = 0;
      for (int i = 0; i < c.frames; ++i) {
        cv::Mat lab = seen_from(pose);
        add_noise(lab, noise, static_cast<unsigned>(i));
        const double e = apart(camera.follow(lab, 1), pose);
        fail_unless(e <= 0.5 + 0.01 * way, "%s, noise %g, frame %d: %g of %g", c.name, noise, i, e,
                    way);
        way += apart(pose * c.step, pose);
        pose = pose * c.step;
      }
    }
}

CHECK_TEST(test_shakes)
{
  // A hand-held camera: shakes do not accumulate.
  CameraMotion camera;
  for (int i = 0; i < 150; ++i) {
    const Similarity pose
        = about_middle(1 + 0.002 * std::sin(0.3 * i), 0.004 * std::sin(0.5 * i),
                       1.2 * std::sin(0.7 * i), 0.8 * std::sin(0.9 * i + 1) - 0.8 * std::sin(1));
    fail_unless_at_most(apart(camera.follow(seen_from(pose), 1), pose), 0.5);
  }
}

CHECK_TEST(test_rests)
{
  // At rest the pose does not change by a bit, whatever the noise. After a motion this holds from
  // the next key frame on, at most 8 frames later.
  for (const double noise : { 0.0, 0.5, 2.0, 4.0 }) {
    CameraMotion camera;
    Similarity pose;
    Similarity last;
    for (int i = 0; i < 160; ++i) {
      if (i >= 60 && i < 80)
        pose = pose * about_middle(1, 0.004, 0.6, -0.2);
      cv::Mat lab = seen_from(pose);
      add_noise(lab, noise, static_cast<unsigned>(i));
      const Similarity now = camera.follow(lab, 1);
      if (i < 60)
        fail_unless(now == Similarity{}, "noise %g, frame %d", noise, i);
      if (i >= 90)
        fail_unless(now == last, "noise %g, frame %d", noise, i);
      last = now;
    }
    fail_unless_at_most(apart(last, pose), 0.7);
  }
}

CHECK_TEST(test_exposure)
{
  // Gain and offset of lightness drift or jump. At rest that is not taken for motion, and a pan is
  // still followed.
  for (const double speed : { 0.0, 0.6 })
    for (const bool at_once : { false, true }) {
      CameraMotion camera;
      for (int i = 0; i < 60; ++i) {
        const double t = at_once ? i / 20 % 2 : std::sin(0.1 * i);
        const Similarity pose = about_middle(1, 0, speed * i, 0);
        const cv::Mat lab = frame(kSize, [&](int x, int y) {
          return 50 + 8 * t + (1 - 0.25 * t) * (surface(pose.x(x, y), pose.y(x, y)) - 50);
        });
        const Similarity now = camera.follow(lab, 1);
        if (speed == 0)
          fail_unless(now == Similarity{}, "frame %d", i);
        else
          fail_unless_at_most(apart(now, pose), 1);
      }
    }
}

CHECK_TEST(test_balls)
{
  // Balls on an even background are not taken for camera motion: one with a radius of up to 12
  // samples, or two smaller ones that approach each other.
  for (const auto &[balls, radius] :
       { std::pair{ 1, 4.0 }, { 1, 9.0 }, { 1, 12.0 }, { 2, 4.0 }, { 2, 6.0 } })
    for (const double noise : { 0.0, 2.0 }) {
      CameraMotion camera;
      for (int i = 0; i < 60; ++i) {
        cv::Mat lab = frame(kSize, [&, count = balls, r = radius](int x, int y) {
          const double d = std::hypot(x - 20 - 1.2 * i, y - 25);
          const double e = std::hypot(x - 90 + 1.2 * i, y - 40);
          return d < r || (count == 2 && e < r) ? 80.0 : 45.0;
        });
        add_noise(lab, noise, static_cast<unsigned>(i));
        fail_unless(camera.follow(lab, 1) == Similarity{}, "%d balls of %g, noise %g, frame %d",
                    balls, radius, noise, i);
      }
    }
}

CHECK_TEST(test_large_object)
{
  // A textured object crosses a still surface. It covers a share of the picture's width and all of
  // its height.
  for (const auto &[share, speed] :
       { std::pair{ 0.2, 0.4 }, { 0.3, 0.4 }, { 0.3, 4.0 }, { 0.5, 1.5 } }) {
    CameraMotion camera;
    for (int i = 0; i < 50; ++i) {
      const double left = 5 + speed * i;
      const double right = left + share * kSize.width;
      const cv::Mat lab = frame(kSize, [&](int x, int y) {
        return x >= left && x < right ? surface(x - left + 300, y + 500) : surface(x, y);
      });
      fail_unless(camera.follow(lab, 1) == Similarity{}, "%g of the width, %g a frame, frame %d",
                  share, speed, i);
    }
  }
}

CHECK_TEST(test_parallax)
{
  // A camera that trucks past a distance and things nearby. No similarity explains both.
  CameraMotion camera;
  int found = 0;
  for (int i = 0; i < 40; ++i) {
    const cv::Mat lab = frame(kSize, [i](int x, int y) {
      const double speed = y < kSize.height / 4 ? 0.5 : 2;
      return surface(x + speed * i + 300, y + 500);
    });
    camera.follow(lab, 1);
    found += camera.moved() ? 1 : 0;
  }
  fail_unless(found >= 35, "moved in %d of 39 frames", found);
}

CHECK_TEST(test_pictures_without_texture)
{
  // Pictures without texture: black, an even picture that brightens, a single edge.
  const std::function<double(int, int)> films[]
      = { [](int, int) { return 0; }, [](int, int i) { return 50 + i; },
          [](int x, int i) {
            return x < 40 + i ? 30 : 70;
          } };
  for (const auto &film : films) {
    CameraMotion camera;
    for (int i = 0; i < 40; ++i) {
      const cv::Mat lab = frame(kSize, [&](int x, int) { return film(x, i); });
      fail_unless(camera.follow(lab, 1) == Similarity{}, "film %d, frame %d",
                  static_cast<int>(&film - films), i);
    }
  }
}

CHECK_TEST(test_noise_alone)
{
  // Noise on an even picture has texture, but no frame repeats it.
  for (const double noise : { 0.5, 1.0, 2.0, 4.0, 10.0 }) {
    CameraMotion camera;
    for (int i = 0; i < 100; ++i) {
      cv::Mat lab = frame(kSize, [](int, int) { return 50; });
      add_noise(lab, noise, static_cast<unsigned>(i));
      fail_unless(camera.follow(lab, 1) == Similarity{}, "noise %g, frame %d", noise, i);
    }
  }
}

CHECK_TEST(test_small_pictures)
{
  // Too small to estimate motion from. A sanitizer sees reads beyond them.
  CameraMotion camera;
  for (int height = 1; height <= 9; ++height)
    for (int width = 1; width <= 9; ++width)
      for (int i = 0; i < 4; ++i)
        fail_unless(camera.follow(seen_from(about_middle(1, 0, i, i), { width, height }), 1)
                    == Similarity{});
  for (const cv::Size size :
       { cv::Size(200, 1), cv::Size(1, 200), cv::Size(200, 2), cv::Size(3, 200), cv::Size(24, 18) })
    for (int i = 0; i < 4; ++i)
      fail_unless(camera.follow(seen_from(about_middle(1, 0, i, i), size), 1) == Similarity{});
}

CHECK_TEST(test_reset)
{
  CameraMotion camera;
  const auto moved = [&](cv::Size size) {
    for (int i = 0; i < 5; ++i)
      camera.follow(seen_from(about_middle(1, 0, i, 0), size), 1);
    return apart(camera.follow(seen_from(about_middle(1, 0, 5, 0), size), 1), {}, size);
  };
  fail_unless_near(moved(kSize), 5, 0.3);
  const cv::Size other(96, 72);
  fail_unless(camera.follow(seen_from({}, other), 1) == Similarity{}); // another size
  fail_unless_near(moved(other), 5, 0.3);
  camera.reset();
  fail_unless(camera.follow(seen_from(about_middle(1, 0, 7, 0), other), 1) == Similarity{});
}

CHECK_TEST(test_key_frames_age)
{
  // Motion is recognized from 0.2 samples within 8 frames at 30 fps. 0.02 samples a frame never
  // count, 0.04 are followed. At four times the frame rate the same speeds decide.
  for (const double speed : { 0.02, 0.04 })
    for (const double elapsed : { 1.0, 0.25 }) {
      CameraMotion camera;
      const int frames = static_cast<int>(80 / elapsed);
      Similarity pose;
      for (int i = 0; i < frames; ++i) {
        const double e = apart(camera.follow(seen_from({ 1, 0, speed * elapsed * i, 0 }), elapsed),
                               speed > 0.03 ? Similarity{ 1, 0, speed * elapsed * i, 0 } : pose);
        fail_unless_at_most(e, speed > 0.03 ? 0.3 : 0);
      }
    }
  // 8 frames pass between two of these, so each is a key frame. Frames that are 3 samples apart are
  // compared with their predecessors.
  CameraMotion camera;
  for (int i = 0; i < 20; ++i)
    fail_unless_at_most(
        apart(camera.follow(seen_from({ 1, 0, 3.0 * i, 0 }), 8), { 1, 0, 3.0 * i, 0 }), 0.5);
}

/// A change of the frame of reference does not change the motion, whatever the key frame's age.
CHECK_TEST(test_rebase)
{
  for (const int when : { 3, 8, 13, 20 }) {
    CameraMotion camera;
    CameraMotion rebased;
    Similarity then;
    Similarity pose;
    for (int i = 0; i < 40; ++i) {
      const cv::Mat lab = seen_from(pose);
      const Similarity far = camera.follow(lab, 1);
      fail_unless_at_most(apart(rebased.follow(lab, 1), then.inverse() * far), 1e-9);
      if (i == when) {
        then = far;
        rebased.rebase();
      }
      pose = pose * about_middle(1.003, -0.004, 0.5, -0.3);
    }
    fail_unless(apart(then, {}) > 1);
  }
}

CHECK_MAIN(camera_motion)
