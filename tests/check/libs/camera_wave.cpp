// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The wave of a travelling camera: its direction, its strength, and that events are alone.
#include "tactile/camera_wave.h"

#include "frame_rate.h"
#include "support/tolerance.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "support/check_tests.h"

using tactile::CameraWave;
using tactile::CameraWay;
using tactile::TactileMap;
using tactile::Time;
using namespace std::chrono_literals;

namespace {

constexpr float kEvent = 0.3F; ///< the weakest

/// The speed of the camera, and whether an event is felt, at a time in seconds.
using Speed = std::function<CameraWay(double)>;
using Event = std::function<bool(double)>;

bool
never(double)
{
  return false;
}

double
seconds(Time time)
{
  return std::chrono::duration<double>(time).count();
}

/// The maps of a film.
std::vector<TactileMap>
maps(const Speed &speed, double length, const FrameRate &rate = kThirty, const Event &event = never)
{
  CameraWave wave;
  std::vector<TactileMap> found;
  for (int i = 0; seconds(rate.frame(i)) < length; ++i) {
    const double time = seconds(rate.frame(i));
    const double passed = seconds(rate.duration(i));
    CameraWay way = speed(time);
    way.right *= passed;
    way.down *= passed;
    way.ahead *= passed;
    TactileMap &map = found.emplace_back(3, 3);
    if (event(time))
      map.at(1, 1) = kEvent;
    wave.follow(way, rate.frame(i), map);
  }
  return found;
}

float
strongest(const TactileMap &map)
{
  return std::ranges::max(map.levels);
}

/// The frame of the second half with the highest level of a cell.
std::ptrdiff_t
crest(const std::vector<TactileMap> &film, int row, int column)
{
  const auto half = film.begin() + static_cast<std::ptrdiff_t>(film.size() / 2);
  return std::ranges::max_element(half, half + 30, {},
                                  [&](const TactileMap &map) { return map.at(row, column); })
         - half;
}

/// How many of 30 frames the wave takes from one cell to another, -15 to 14.
int
frames_between(const std::vector<TactileMap> &film, int row, int column, int to_row, int to_column)
{
  const auto frames = crest(film, to_row, to_column) - crest(film, row, column);
  return static_cast<int>((frames + 45) % 30) - 15;
}

} // namespace

/// At the highest speed the wave takes a second over the picture, so 10 frames to the next cell.
CHECK_TEST(test_direction)
{
  const double fast = 2 * CameraWave::kFastest;
  const auto right = maps([=](double) { return CameraWay{ .right = fast }; }, 8);
  fail_unless_equals_int(frames_between(right, 0, 0, 0, 1), 10);
  fail_unless_equals_int(frames_between(right, 0, 1, 0, 2), 10);
  fail_unless_equals_int(frames_between(right, 0, 0, 2, 0), 0);
  const auto left = maps([=](double) { return CameraWay{ .right = -fast }; }, 8);
  fail_unless_equals_int(frames_between(left, 0, 2, 0, 1), 10);
  const auto down = maps([=](double) { return CameraWay{ .down = fast }; }, 8);
  fail_unless_equals_int(frames_between(down, 0, 0, 1, 0), 10);
  fail_unless_equals_int(frames_between(down, 0, 0, 0, 2), 0);
  const auto ahead = maps([=](double) { return CameraWay{ .ahead = 4 * fast }; }, 8);
  fail_unless_equals_int(frames_between(ahead, 0, 1, 0, 0), 10);
  fail_unless_equals_int(frames_between(ahead, 0, 1, 0, 2), 10);
  const auto back = maps([=](double) { return CameraWay{ .ahead = -4 * fast }; }, 8);
  fail_unless_equals_int(frames_between(back, 0, 0, 0, 1), 10);
}

/// From nothing at the slowest speed to the highest level at the fastest, in proportion, at any
/// frame rate.
CHECK_TEST(test_level)
{
  for (const double share : { -0.1, 0.0, 0.25, 0.5, 1.0, 3.0 }) {
    const double speed
        = CameraWave::kSlowest + share * (CameraWave::kFastest - CameraWave::kSlowest);
    for (const int fps : { 24, 30, 60 }) {
      const auto film
          = maps([=](double) { return CameraWay{ .right = speed }; }, 40, FrameRate{ fps, 1 });
      float most = 0;
      for (std::size_t i = film.size() / 2; i < film.size(); ++i)
        most = std::max(most, strongest(film[i]));
      fail_unless_near(static_cast<double>(most), CameraWave::kMost * std::clamp(share, 0.0, 1.0),
                       0.01 * CameraWave::kMost);
    }
  }
}

/// A camera that shakes, by 5 of 640 pixels five times a second, or that rests.
CHECK_TEST(test_shake)
{
  const auto shakes = [](double time) {
    constexpr double kCircle = 2 * std::numbers::pi * 5;
    return CameraWay{ .right = 5.0 / 640 * kCircle * std::cos(kCircle * time) };
  };
  for (const Speed &speed : { Speed(shakes), Speed([](double) { return CameraWay{}; }) })
    for (const TactileMap &map : maps(speed, 5))
      fail_unless_near(static_cast<double>(strongest(map)), 0, 0);
}

/// A map with an event stays as it is. The wave is weaker than any event, and returns softly.
CHECK_TEST(test_events_are_alone)
{
  const auto event = [](double time) {
    return std::fmod(time, 4) >= 3;
  };
  const auto film = maps([](double) { return CameraWay{ .right = 1 }; }, 12, kThirty, event);
  for (std::size_t i = 0; i < film.size(); ++i)
    if (event(seconds(kThirty.frame(static_cast<int>(i))))) {
      TactileMap alone(3, 3);
      alone.at(1, 1) = kEvent;
      fail_unless(film[i].levels == alone.levels);
    } else
      fail_unless(strongest(film[i]) < kEvent);
  fail_unless_at_most(static_cast<double>(strongest(film[120])), 0.1 * CameraWave::kMost);
  fail_unless(static_cast<double>(strongest(film[170])) > 0.6 * CameraWave::kMost);
}

/// After a cut, a seek or a gap the wave begins anew.
CHECK_TEST(test_begins_anew)
{
  const CameraWay way{ .right = 1.0 / 30 };
  for (const int jump : { 0, 1, 2 }) {
    CameraWave wave;
    TactileMap map(3, 3);
    Time time{ 0 };
    const auto frame = [&] {
      map = TactileMap(3, 3);
      wave.follow(way, time, map);
      time += 33ms;
    };
    for (int i = 0; i < 90; ++i)
      frame();
    fail_unless(strongest(map) > 0);
    if (jump == 0)
      wave.reset();
    else
      time += jump == 1 ? -2s : 2s;
    for (int i = 0; i < 2; ++i) {
      frame();
      fail_unless_at_most(static_cast<double>(strongest(map)), 0.1 * CameraWave::kMost);
    }
  }
}

CHECK_MAIN(camera_wave)
