// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The viewport, and maps through a viewport.
#include "tactile/viewport.h"

#include "frame_rate.h"
#include "saliency_map.h"
#include "support/tolerance.h"
#include "tactile/tactile_mapping.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <set>
#include <vector>

#include "support/check_tests.h"

using tactile::AdaptiveViewport;
using tactile::Gain;
using tactile::MappingSettings;
using tactile::SaliencyView;
using tactile::TactileMap;
using tactile::Time;
using tactile::Viewport;
using namespace std::chrono_literals;

namespace {

constexpr double kFloor = 0.5;
constexpr double kThreshold = 0.5;
constexpr MappingSettings kPooling{ .floor = kFloor, .threshold = kThreshold, .gain = Gain::none };

std::size_t
strongest(const Map &map, const Viewport &viewport)
{
  TactileMap out(3, 3);
  map_saliency(map.view(), kPooling, out, viewport);
  return static_cast<std::size_t>(std::ranges::max_element(out.levels) - out.levels.begin());
}

void
fail_unless_same(const Viewport &a, const Viewport &b, double tolerance)
{
  fail_unless_near(a.left, b.left, tolerance);
  fail_unless_near(a.top, b.top, tolerance);
  fail_unless_near(a.width, b.width, tolerance);
  fail_unless_near(a.height, b.height, tolerance);
}

/// The part of an axis that cell `cell` of `cells` covers in a viewport. The picture covers [begin,
/// begin + length) of the samples. The outermost cells include what is outside the viewport.
struct Span
{
  double begin;
  double end;
};

Span
cell_span(double begin, double length, double from, double share, int cells, int cell)
{
  const double step = length * share / cells;
  return { cell == 0 ? begin : begin + length * from + step * cell,
           cell + 1 == cells ? begin + length : begin + length * from + step * (cell + 1) };
}

double
overlap(const Span &span, int sample)
{
  return std::max(0.0, std::min(sample + 1.0, span.end) - std::max(1.0 * sample, span.begin));
}

} // namespace

/// By area: each sample counts in the cell that contains it or is nearest, with the weight of its
/// area in that cell.
CHECK_TEST(test_mapping_by_area)
{
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 60; ++i) {
    Map map(1 + static_cast<int>(generator() % 40), 1 + static_cast<int>(generator() % 30));
    for (float &value : map.values)
      value = static_cast<float>(uniform(generator)) * 0.05F;
    SaliencyView view = map.view();
    view.horizontal = { 0.4 * uniform(generator), map.width - 0.3 };
    view.vertical = { 0.4 * uniform(generator), map.height + 0.2 };
    Viewport viewport{ .width = 0.2 + 0.8 * uniform(generator),
                       .height = 0.2 + 0.8 * uniform(generator) };
    viewport.left = (1 - viewport.width) * uniform(generator);
    viewport.top = (1 - viewport.height) * uniform(generator);
    const int rows = 1 + static_cast<int>(generator() % 5);
    const int columns = 1 + static_cast<int>(generator() % 5);
    TactileMap out(rows, columns);
    map_saliency(view, { .floor = 0, .threshold = 0, .gain = Gain::none }, out, viewport);

    const double area = view.horizontal.length * viewport.width / columns * view.vertical.length
                        * viewport.height / rows;
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) {
        const Span across = cell_span(view.horizontal.begin, view.horizontal.length, viewport.left,
                                      viewport.width, columns, c);
        const Span down = cell_span(view.vertical.begin, view.vertical.length, viewport.top,
                                    viewport.height, rows, r);
        double sum = 0;
        for (int y = -2; y < map.height + 2; ++y)
          for (int x = -2; x < map.width + 2; ++x) {
            const int nearest
                = std::clamp(y, 0, map.height - 1) * map.width + std::clamp(x, 0, map.width - 1);
            sum += overlap(across, x) * overlap(down, y)
                   * static_cast<double>(map.values[static_cast<std::size_t>(nearest)]);
          }
        fail_unless_near(out.at(r, c), std::min(1.0, sum / area), 1e-6);
      }
  }
}

/// By a Gaussian: a spot outside the viewport counts as one on its border.
CHECK_TEST(test_mapping_by_gaussian)
{
  MappingSettings settings = kPooling;
  settings.prefilter_sigma = 1.0 / 3;
  const Viewport viewport{ .left = 0.25, .top = 0.25, .width = 0.5, .height = 0.5 };
  for (const double x : { 0.05, 0.5, 0.95 })
    for (const double y : { 0.05, 0.5, 0.95 }) {
      TactileMap out(3, 3);
      map_saliency(Map(90, 90).spot(x, y, 1, 1).view(), settings, out, viewport);
      const auto cell = static_cast<std::size_t>(3 * std::lround(2 * y - 0.05 * (y > 0.5))
                                                 + std::lround(2 * x - 0.05 * (x > 0.5)));
      ck_assert_uint_eq(
          static_cast<std::size_t>(std::ranges::max_element(out.levels) - out.levels.begin()),
          cell);
      // A spot half a cell from the nearest cell's center is at 1.5 σ, one at the center at 0 σ.
      const auto felt = [&](double z) {
        return z == 0.5 ? 1.0 : std::exp(-0.5 * 1.5 * 1.5);
      };
      // A cell has 15 samples, so σ is 5 samples: the Gaussian's sum is 2 π σ².
      fail_unless_near(out.levels[cell], felt(x) * felt(y) / (2 * std::numbers::pi * 5 * 5),
                       0.0006);
    }
}

/// The weight of the center is that of the picture's, not of the viewport's.
CHECK_TEST(test_center_weight)
{
  const Viewport viewport{ .left = 0.4, .top = 0, .width = 0.6, .height = 0.5 };
  MappingSettings settings{ .floor = 0, .threshold = 0, .gain = Gain::none };
  TactileMap even(1, 3);
  TactileMap out(1, 3);
  map_saliency(Map(20, 20, 0.05F).view(), settings, even, viewport);
  settings.center_weight = 0.7;
  map_saliency(Map(20, 20, 0.05F).view(), settings, out, viewport);
  // Middles of the cells are at 0.5, 0.7 and 0.9 across, 0.25 down.
  for (int c = 0; c < 3; ++c)
    fail_unless_near(out.at(0, c) / even.at(0, c),
                     0.3 + 0.7 * std::exp(-(0.04 * c * c + 0.0625) / 0.125), 1e-6);
}

/// A viewport of the whole picture gives bit-identical maps to none.
CHECK_TEST(test_whole_picture)
{
  std::mt19937 generator(5);
  for (const double sigma : { 0.0, 1.0 / 3 })
    for (int i = 0; i < 20; ++i) {
      Map map(5 + static_cast<int>(generator() % 50), 5 + static_cast<int>(generator() % 50));
      for (float &value : map.values)
        value = static_cast<float>(generator() % 1000) / 1000.0F;
      MappingSettings settings = MappingSettings::tuned();
      settings.prefilter_sigma = sigma;
      TactileMap whole(7, 5);
      TactileMap part(7, 5);
      map_saliency(map.view(), settings, whole);
      map_saliency(map.view(), settings, part, { 0, 0, 1, 1 });
      fail_unless(whole == part);
    }
}

/// A small object moves within the middle third of a wide shot. With the whole picture only the
/// middle column plays. With the adaptive viewport the left, middle and right ones do.
CHECK_TEST(test_small_events_in_the_middle)
{
  AdaptiveViewport adaptive;
  std::set<std::size_t> fixed_cells;
  std::set<std::size_t> first_cells;
  std::set<std::size_t> last_cells;
  const FrameRate rate{ 30, 1 };
  for (int i = 0; i < 20 * 30; ++i) {
    const double turn = std::sin(2 * std::numbers::pi * i / 90);
    const Map map = Map(96, 54).spot(0.5 + 0.14 * turn, 0.5, 2, 1);
    const Viewport viewport = adaptive.follow(map.view(), kFloor, kThreshold, rate.frame(i));
    fixed_cells.insert(strongest(map, {}));
    (i < 90 ? first_cells : last_cells).insert(strongest(map, viewport));
  }
  fail_unless(fixed_cells == std::set<std::size_t>{ 4 });
  fail_unless((last_cells == std::set<std::size_t>{ 3, 4, 5 }));
  fail_unless(first_cells.contains(4));
}

/// Events all over the picture keep their cells. They come at each cell's center in turn, in any
/// order.
CHECK_TEST(test_events_everywhere)
{
  std::mt19937 generator(11);
  AdaptiveViewport adaptive;
  const FrameRate rate{ 30, 1 };
  std::vector<std::size_t> cells{ 0, 1, 2, 3, 4, 5, 6, 7, 8 };
  int same = 0;
  int frames = 0;
  for (int i = 0; i < 60 * 30; ++i) {
    if (i / 10 % 9 == 0 && i % 10 == 0)
      std::ranges::shuffle(cells, generator);
    const std::size_t cell = cells[static_cast<std::size_t>(i / 10 % 9)];
    const Map map = Map(96, 54).spot((static_cast<double>(cell % 3) + 0.5) / 3,
                                     (static_cast<double>(cell / 3) + 0.5) / 3, 6, 1);
    const Viewport viewport = adaptive.follow(map.view(), kFloor, kThreshold, rate.frame(i));
    ck_assert_uint_eq(strongest(map, {}), cell);
    same += strongest(map, viewport) == cell;
    frames++;
  }
  ck_assert_int_eq(same, frames);
}

/// The viewport for a still spot by its definition: weight w = 1 − exp(−t / 8 s) for the past, 0.2
/// for the whole picture, mean ± 2 σ.
CHECK_TEST(test_closed_form)
{
  for (const FrameRate &rate : { FrameRate{ 24, 1 }, { 30000, 1001 }, { 60, 1 } })
    for (const double place : { 0.3, 0.5 }) {
      AdaptiveViewport adaptive;
      // One sample whose center is at `place`.
      Map map(10, 10);
      map.values[static_cast<std::size_t>(50 + std::lround(place * 10 - 0.5))] = 1;
      SaliencyView view = map.view();
      view.horizontal = { std::lround(place * 10 - 0.5) + 0.5 - place * 10, 10 };
      Viewport viewport;
      double time = 0;
      for (int i = 0; time < 30; ++i) {
        time = std::chrono::duration<double>(rate.frame(i)).count();
        viewport = adaptive.follow(view, kFloor, kThreshold, rate.frame(i));
      }
      const double weight = 1 - std::exp(-time / 8);
      const double mean = (weight * place + 0.2 * 0.5) / (weight + 0.2);
      const double square = (weight * place * place + 0.2 / 3) / (weight + 0.2);
      const double length = 4 * std::sqrt(square - mean * mean);
      fail_unless_near(viewport.width, length, 1e-3); // borders move at a limited speed
      fail_unless_near(viewport.left, std::max(0.0, mean - length / 2), 1e-3);
      if (place == 0.5)
        fail_unless(viewport.width > 0.47 && viewport.width < 0.48);
    }
}

/// For any film the viewport stays within the picture and is at least 0.47 wide. No border moves
/// faster than a quarter of the picture a second.
CHECK_TEST(test_bounds)
{
  std::mt19937 generator(17);
  std::uniform_real_distribution<double> uniform(0, 1);
  AdaptiveViewport adaptive;
  Viewport last;
  Time time{ 0 };
  for (int i = 0; i < 5000; ++i) {
    Map map(32, 18);
    if (i / 100 % 3)
      map.spot(i / 600 % 2 ? uniform(generator) : 0.5, 0.4 + 0.2 * uniform(generator), 2, 1);
    const Time step = std::chrono::milliseconds(1 + generator() % 80);
    time += step;
    const Viewport now = adaptive.follow(map.view(), kFloor, kThreshold, time);
    fail_unless(now.left >= 0 && now.top >= 0);
    fail_unless_at_most(now.left + now.width, 1 + 1e-12);
    fail_unless_at_most(now.top + now.height, 1 + 1e-12);
    fail_unless(now.width > 0.47 && now.height > 0.47);
    const double reach = 0.25 * std::chrono::duration<double>(step).count() + 1e-12;
    fail_unless_at_most(std::abs(now.left - last.left), reach);
    fail_unless_at_most(std::abs(now.top - last.top), reach);
    fail_unless_at_most(std::abs(now.left + now.width - last.left - last.width), reach);
    fail_unless_at_most(std::abs(now.top + now.height - last.top - last.height), reach);
    last = now;
  }
}

/// The viewport is the same at any frame rate, also at a variable one.
CHECK_TEST(test_rates_agree)
{
  const auto film = [](Time time) {
    const double t = std::chrono::duration<double>(time).count();
    Map map(64, 36);
    if (std::fmod(t, 5) < 3)
      map.spot(0.5 + 0.2 * std::sin(t), 0.4, 3, 1);
    return map;
  };
  const auto after = [&](auto next_time) {
    AdaptiveViewport adaptive;
    Viewport viewport;
    for (int i = 0; next_time(i) <= 20s; ++i)
      viewport = adaptive.follow(film(next_time(i)).view(), kFloor, kThreshold, next_time(i));
    return viewport;
  };
  const Viewport reference = after([](int i) { return Time(i * 1ms); });
  fail_unless(reference.width < 0.8);
  for (const FrameRate &rate : { FrameRate{ 24, 1 }, { 25, 1 }, { 30, 1 }, { 50, 1 }, { 60, 1 } })
    fail_unless_same(after([&](int i) { return rate.frame(i); }), reference, 0.01);
  fail_unless_same(after([](int i) { return Time(i * 30ms + i % 3 * 9ms); }), reference, 0.01);
}

/// After three seconds of silence the viewport returns to the whole picture at its limited speed.
/// Values up to the floor count as silence.
CHECK_TEST(test_silence)
{
  const Map spot = Map(60, 60).spot(0.5, 0.5, 2, 1);
  const Map noise = Map(60, 60).spot(0.5, 0.5, 2, 0.5F);
  AdaptiveViewport adaptive;
  Viewport viewport;
  Time time{ 0 };
  for (; time <= 20s; time += 50ms)
    viewport = adaptive.follow(spot.view(), kFloor, kThreshold, time);
  const Viewport narrow = viewport;
  fail_unless(narrow.width < 0.5 && narrow.height < 0.5);
  for (; time < 23s; time += 50ms)
    viewport = adaptive.follow(noise.view(), kFloor, kThreshold, time);
  fail_unless(viewport.width < 0.6); // it relaxes a little
  fail_unless(viewport.width >= narrow.width);
  for (; time <= 25s; time += 50ms)
    viewport = adaptive.follow(noise.view(), kFloor, kThreshold, time);
  fail_unless(viewport == Viewport());
  // Its past is forgotten: one frame does not bring it back.
  viewport = adaptive.follow(spot.view(), kFloor, kThreshold, time);
  fail_unless(viewport.width > 0.98);
}

CHECK_TEST(test_resets)
{
  const Map spot = Map(60, 60).spot(0.5, 0.5, 2, 1);
  AdaptiveViewport adaptive;
  const auto narrow = [&] {
    Viewport viewport;
    for (Time time{ 10s }; time <= 30s; time += 50ms)
      viewport = adaptive.follow(spot.view(), kFloor, kThreshold, time);
    fail_unless(viewport.width < 0.5);
  };
  narrow();
  fail_unless(adaptive.follow(spot.view(), kFloor, kThreshold, 30s).width < 0.5);
  fail_unless(adaptive.follow(spot.view(), kFloor, kThreshold, 30s - 1ns) == Viewport());
  adaptive.reset();
  narrow();
  adaptive.reset();
  fail_unless(adaptive.follow(spot.view(), kFloor, kThreshold, 31s) == Viewport());
}

/// Empty maps, maps without finite values, and times near the ends of their range.
CHECK_TEST(test_bad_input)
{
  AdaptiveViewport adaptive;
  fail_unless(adaptive.follow({}, 0, 0, 0s) == Viewport());
  Map map(3, 3);
  std::ranges::fill(map.values, std::numeric_limits<float>::quiet_NaN());
  fail_unless(adaptive.follow(map.view(), 0, 0, 1s) == Viewport());
  map.values[4] = std::numeric_limits<float>::max();
  Viewport viewport;
  for (Time time{ 1'000'000'000'000'000'000 }; time <= Time(1'000'000'005'000'000'000); time += 1s)
    viewport = adaptive.follow(map.view(), 0, 1, time); // the maximum itself counts
  fail_unless(viewport.width > 0.5 && viewport.width < 1);
}

CHECK_MAIN(viewport)
