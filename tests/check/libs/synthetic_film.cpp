// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactile/synthetic_film.h"

#include "support/check_tests.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <vector>

using namespace std::chrono_literals;
using namespace tactile;

namespace {

constexpr int kWidth = 1000;
constexpr int kHeight = 800;
constexpr Time kStep = 10ms;

/// A picture of one component.
struct Picture
{
  int width;
  int height;
  int stride;
  std::vector<std::uint8_t> samples;

  Picture(int width_, int height_, std::uint8_t value, int padding = 3)
      : width(width_), height(height_), stride(width_ + padding),
        samples(static_cast<std::size_t>(stride) * static_cast<std::size_t>(height_), value)
  {
  }

  SamplePlane plane(int block = 1)
  {
    return { .data = samples.data(),
             .row_stride = stride,
             .width = width,
             .height = height,
             .block_width = block,
             .block_height = block };
  }

  double at(int x, int y) const
  {
    return samples[static_cast<std::size_t>(y) * static_cast<std::size_t>(stride)
                   + static_cast<std::size_t>(x)];
  }
};

/// When the film's balls change, found by stepping through it: times, and the balls from then on.
struct Event
{
  Time time;
  std::vector<Ball> balls;
};

std::vector<Event>
walk(const SyntheticFilm &film, Time until)
{
  std::vector<Event> events;
  for (Time t{ 0 }; t < until; t += kStep) {
    std::vector<Ball> balls = film.balls_at(t, kWidth, kHeight);
    if (events.empty() || balls != events.back().balls)
      events.push_back({ t, std::move(balls) });
  }
  return events;
}

bool
in_picture(const Ball &ball, int width, int height)
{
  constexpr double kRounding = 1e-9;
  return ball.x - ball.radius >= -kRounding && ball.x + ball.radius <= width + kRounding
         && ball.y - ball.radius >= -kRounding && ball.y + ball.radius <= height + kRounding;
}

int
third(double position, int size)
{
  return static_cast<int>(3 * position / size);
}

} // namespace

CHECK_TEST(test_static_motion)
{
  for (std::uint64_t seed = 0; seed < 5; seed++) {
    const SyntheticFilm film({ .seed = seed });
    const std::vector<Event> events = walk(film, 200s);
    fail_unless(events[0].balls.empty());
    fail_unless(events[1].time == SyntheticFilm::kEmptyStart);
    int pairs = 0;
    int singles = 0;
    int long_rests = 0;
    for (std::size_t i = 1; i + 1 < events.size(); i++) {
      const Time rest = events[i + 1].time - events[i].time;
      fail_unless(rest > 1s && rest <= 5s + kStep); // more than a second (paper, section 5)
      long_rests += rest > 3s;
      const std::vector<Ball> &balls = events[i].balls;
      fail_unless(balls.size() == 1 || balls.size() == 2);
      (balls.size() == 2 ? pairs : singles)++;
      if (balls.size() == 2) {
        fail_unless(third(balls[0].x, kWidth) != third(balls[1].x, kWidth));
        fail_unless(balls[0].color == balls[1].color);
      }
      for (const Ball &ball : balls) {
        fail_unless(in_picture(ball, kWidth, kHeight));
        fail_unless_equals_float(ball.radius, kWidth / 32.0);
        fail_if(ball.moving);
        fail_unless(ball.onset > events[i].time - kStep && ball.onset <= events[i].time);
        for (const Ball &before : events[i - 1].balls) // at other places
          fail_unless(third(ball.x, kWidth) != third(before.x, kWidth)
                      || third(ball.y, kHeight) != third(before.y, kHeight));
      }
    }
    fail_unless(pairs >= 10 && singles >= 10 && long_rests >= 5,
                "%d pairs, %d singles, %d long rests", pairs, singles, long_rests);
  }
}

CHECK_TEST(test_dynamic_motion)
{
  for (std::uint64_t seed = 0; seed < 5; seed++) {
    const SyntheticFilm film({ .pattern = FilmPattern::dynamic_motion, .seed = seed });
    fail_unless(film.balls_at(0s, kWidth, kHeight).empty());
    Ball last = film.balls_at(SyntheticFilm::kEmptyStart, kWidth, kHeight).at(0);
    fail_unless(last.moving && last.onset == SyntheticFilm::kEmptyStart);

    double slowest = 1e9;
    double fastest = 0;
    Time since = SyntheticFilm::kEmptyStart; // of the current movement or stop
    int long_stalls = 0;
    for (Time t = SyntheticFilm::kEmptyStart + kStep; t < 200s; t += kStep) {
      const std::vector<Ball> balls = film.balls_at(t, kWidth, kHeight);
      fail_unless_equals_int(balls.size(), 1);
      const Ball &ball = balls[0];
      fail_unless(in_picture(ball, kWidth, kHeight));
      const double speed = std::hypot(ball.x - last.x, ball.y - last.y)
                           / std::chrono::duration<double>(kStep).count() / kWidth;
      if (ball.moving && last.moving && ball.onset == last.onset) {
        slowest = std::min(slowest, speed);
        fastest = std::max(fastest, speed);
      }
      if (!ball.moving && !last.moving)
        fail_unless(speed == 0);
      if (ball.moving && !last.moving) {
        fail_unless(ball.onset > t - kStep && ball.onset <= t);
        long_stalls += t - since > 2500ms;
      } else if (ball.onset != last.onset) {
        fail("onset without a stall before it");
      }
      if (ball.moving != last.moving)
        since = t;
      last = ball;
    }
    // In picture widths a second: it never rests while it moves, its speed varies, and it does not
    // jump.
    fail_unless(slowest > 0.02, "%g", slowest);
    fail_unless(fastest > 5 * slowest && fastest < 2, "%g to %g", slowest, fastest);
    fail_unless(long_stalls >= 3, "%d", long_stalls);
  }
}

CHECK_TEST(test_function_of_seed_and_time)
{
  for (const FilmPattern pattern : { FilmPattern::static_motion, FilmPattern::dynamic_motion }) {
    const SyntheticFilm film({ .pattern = pattern, .seed = 4 });
    const SyntheticFilm same({ .pattern = pattern, .seed = 4 });
    const SyntheticFilm other({ .pattern = pattern, .seed = 5 });
    int different = 0;
    for (const Time t : { 77s, 3s, 500s, 12s }) { // in any order
      fail_unless(film.balls_at(t, kWidth, kHeight) == same.balls_at(t, kWidth, kHeight));
      different += film.balls_at(t, kWidth, kHeight) != other.balls_at(t, kWidth, kHeight);

      std::vector<Ball> again = film.balls_at(t + 3 * SyntheticFilm::kPeriod, kWidth, kHeight);
      for (Ball &ball : again)
        ball.onset -= 3 * SyntheticFilm::kPeriod;
      fail_unless(again == film.balls_at(t, kWidth, kHeight));
    }
    fail_unless(different >= 3);
    fail_unless(film.balls_at(-5s, kWidth, kHeight) == film.balls_at(0s, kWidth, kHeight));
    fail_if(film.balls_at(Time::max(), kWidth, kHeight).size() > 2);
  }
}

CHECK_TEST(test_settings)
{
  for (const int balls : { 1, 2 })
    for (const FilmPattern pattern : { FilmPattern::static_motion, FilmPattern::dynamic_motion }) {
      const SyntheticFilm film(
          { .pattern = pattern, .seed = 1, .balls = balls, .ball_size = 0.25 });
      for (Time t = 1s; t < 60s; t += 1s) {
        const std::vector<Ball> now = film.balls_at(t, kWidth, kHeight);
        fail_unless_equals_int(now.size(), balls);
        for (const Ball &ball : now) {
          fail_unless_equals_float(ball.radius, kWidth / 8.0);
          fail_unless(in_picture(ball, kWidth, kHeight));
        }
      }
    }
  fail_unless(SyntheticFilm({ .balls = 99 }).balls_at(2s, 10, 10).size() == 2);
  fail_unless(SyntheticFilm({ .balls = -1, .ball_size = 9 }).balls_at(2s, 10, 10).at(0).radius
              == 5);
}

CHECK_TEST(test_any_size)
{
  // Another size shows the same film: positions scale with the space that a ball can move in.
  const SyntheticFilm film({ .seed = 2, .balls = 1 });
  const Ball small = film.balls_at(2s, 100, 80).at(0);
  const Ball large = film.balls_at(2s, 1000, 800).at(0);
  fail_unless(std::abs(large.x - 10 * small.x) < 1e-9 && std::abs(large.y - 10 * small.y) < 1e-9);

  // A ball that does not fit is centered.
  const Ball flat = film.balls_at(2s, 1600, 10).at(0);
  fail_unless_equals_float(flat.y, 5);
  fail_unless_equals_float(flat.radius, 50);
  fail_unless(film.balls_at(2s, 1, 1).size() == 1);
}

CHECK_TEST(test_drawn_area_and_center)
{
  for (const double radius : { 0.1, 0.4, 1.0, 3.7, 20.25 })
    for (const double x : { 30.0, 30.5, 31.3 }) {
      Picture picture(64, 60, 50);
      const Ball ball{ .x = x, .y = 29.6, .radius = radius };
      draw_ball(picture.plane(), ball, 250);

      double area = 0;
      double sum_x = 0;
      double sum_y = 0;
      for (int row = 0; row < picture.height; row++)
        for (int column = 0; column < picture.width; column++) {
          const double share = (picture.at(column, row) - 50) / 200;
          area += share;
          sum_x += share * (column + 0.5);
          sum_y += share * (row + 0.5);
          const bool outside = column < std::floor(x - radius) || column >= std::ceil(x + radius)
                               || row < std::floor(29.6 - radius)
                               || row >= std::ceil(29.6 + radius);
          fail_if(outside && share != 0);
        }
      if (radius >= 1) {
        const double exact = std::numbers::pi * radius * radius;
        fail_unless(std::abs(area / exact - 1) < (radius < 3 ? 0.15 : 0.02), "%g for %g", area,
                    exact);
        fail_unless(std::abs(sum_x / area - x) < 0.05, "%g for %g", sum_x / area, x);
        fail_unless(std::abs(sum_y / area - 29.6) < 0.05, "%g", sum_y / area);
      } else {
        fail_unless(area <= 4 * std::numbers::pi * radius * radius, "%g for radius %g", area,
                    radius);
      }
      for (int row = 0; row < picture.height; row++) // bytes between the rows are not modified
        for (int column = picture.width; column < picture.stride; column++)
          fail_unless(picture.at(column, row) == 50);
    }
}

CHECK_TEST(test_drawn_inside_and_outside)
{
  Picture picture(64, 60, 50);
  const Ball ball{ .x = 5.2, .y = 30, .radius = 12.5 }; // beyond the left edge
  draw_ball(picture.plane(), ball, 10);
  for (int row = 0; row < picture.height; row++)
    for (int column = 0; column < picture.width; column++) {
      const double distance = std::hypot(column + 0.5 - ball.x, row + 0.5 - ball.y);
      if (distance < ball.radius - std::numbers::sqrt2 / 2)
        fail_unless(picture.at(column, row) == 10);
      if (distance > ball.radius + std::numbers::sqrt2 / 2)
        fail_unless(picture.at(column, row) == 50);
    }

  Picture untouched(8, 8, 50); // far outside, on all sides
  for (const auto &[x, y] :
       { std::pair{ -40.0, 4.0 }, { 50.0, 4.0 }, { 4.0, -40.0 }, { 4.0, 50.0 } })
    draw_ball(untouched.plane(), { .x = x, .y = y, .radius = 12.5 }, 10);
  fail_unless(std::ranges::all_of(untouched.samples, [](int v) { return v == 50; }));
}

CHECK_TEST(test_drawn_in_subsampled_components)
{
  // A sample of 2 × 2 pixels is about their mean.
  Picture fine(128, 128, 0);
  Picture coarse(64, 64, 0);
  const Ball ball{ .x = 61.3, .y = 70.9, .radius = 33.3 };
  draw_ball(fine.plane(), ball, 240);
  draw_ball(coarse.plane(2), ball, 240);
  double difference = 0;
  for (int row = 0; row < coarse.height; row++)
    for (int column = 0; column < coarse.width; column++) {
      const double mean
          = (fine.at(2 * column, 2 * row) + fine.at(2 * column + 1, 2 * row)
             + fine.at(2 * column, 2 * row + 1) + fine.at(2 * column + 1, 2 * row + 1))
            / 4;
      difference = std::max(difference, std::abs(mean - coarse.at(column, row)));
    }
  fail_unless(difference <= 0.11 * 240, "%g", difference);
}

CHECK_TEST(test_noise_distribution)
{
  for (const double sigma : { 0.5, 1.0, 2.0, 4.0, 32.0 }) {
    Picture picture(601, 500, 128, 0);
    SensorNoise(sigma, 7).add(picture.plane(), 0, 40ms);
    const auto n = static_cast<double>(picture.samples.size());
    double sum = 0;
    double squares = 0;
    double fourths = 0;
    double neighbors = 0;
    for (std::size_t i = 0; i < picture.samples.size(); i++) {
      const double v = picture.samples[i] - 128.0;
      sum += v;
      squares += v * v;
      fourths += v * v * v * v;
      if (i > 0)
        neighbors += v * (picture.samples[i - 1] - 128.0);
    }
    const double variance = squares / n;
    const double expected = sigma * sigma + 1.0 / 12; // for rounding to codes (Sheppard)
    fail_unless(std::abs(sum / n) < 5 * sigma / std::sqrt(n), "mean %g", sum / n);
    if (sigma >= 1)
      fail_unless(std::abs(variance / expected - 1) < 0.02, "variance %g for %g", variance,
                  expected);
    if (sigma >= 2)
      fail_unless(std::abs(fourths / n / (variance * variance) - 3) < 0.1, "kurtosis %g",
                  fourths / n / variance / variance);
    fail_unless(std::abs(neighbors / n / variance) < 5 / std::sqrt(n), "correlation %g",
                neighbors / n / variance);
  }
}

CHECK_TEST(test_noise_is_a_function)
{
  const auto noisy = [](std::uint64_t seed, int component, Time time, double sigma = 4) {
    Picture picture(64, 64, 128);
    SensorNoise(sigma, seed).add(picture.plane(), component, time);
    return picture.samples;
  };
  const auto correlation
      = [](const std::vector<std::uint8_t> &a, const std::vector<std::uint8_t> &b) {
          double product = 0;
          for (std::size_t i = 0; i < a.size(); i++)
            product += (a[i] - 128.0) * (b[i] - 128.0);
          return product / 16 / (64 * 64);
        };
  const auto reference = noisy(1, 0, 40ms);
  fail_unless(reference == noisy(1, 0, 40ms));
  for (const auto &other : { noisy(2, 0, 40ms), noisy(1, 1, 40ms), noisy(1, 0, 41ms) })
    fail_unless(std::abs(correlation(reference, other)) < 0.08, "%g",
                correlation(reference, other));
  fail_unless(correlation(reference, reference) > 0.9);

  const auto silent = noisy(1, 0, 40ms, 0);
  fail_unless(std::ranges::all_of(silent, [](int v) { return v == 128; }));
}

CHECK_TEST(test_noise_is_bounded)
{
  for (const std::uint8_t value : { 0, 255 }) {
    Picture picture(64, 64, value);
    SensorNoise(32, 1).add(picture.plane(), 0, 0s);
    int changed = 0;
    for (int y = 0; y < 64; y++)
      for (int x = 0; x < 64; x++)
        changed += picture.at(x, y) != value;
    // Half of the noise is clipped. If it wrapped around, nearly all samples would differ.
    fail_unless(changed > 64 * 64 * 4 / 10 && changed < 64 * 64 * 6 / 10, "%d", changed);
    for (int y = 0; y < 64; y++)
      for (int x = 64; x < picture.stride; x++)
        fail_unless(picture.at(x, y) == value);
  }

  // Bytes between the component's samples are not modified.
  Picture packed(63, 10, 128, 0);
  SamplePlane plane = packed.plane();
  plane.pixel_stride = 3;
  plane.width = 21;
  SensorNoise(8, 1).add(plane, 0, 0s);
  for (std::size_t i = 0; i < packed.samples.size(); i++)
    fail_if(i % 63 % 3 != 0 && packed.samples[i] != 128);
}

CHECK_MAIN(synthetic_film)
