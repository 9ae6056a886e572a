// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactile/cue_limiter.h"

#include "frame_rate.h"
#include "support/tolerance.h"

#include <algorithm>
#include <functional>
#include <random>
#include <vector>

#include "support/check_tests.h"

using tactile::CueLimiter;
using tactile::CueLimits;
using tactile::TactileMap;
using tactile::Time;
using namespace std::chrono_literals;

namespace {

constexpr FrameRate kRates[]
    = { { 24, 1 }, { 25, 1 }, { 30000, 1001 }, { 30, 1 }, { 50, 1 }, { 60, 1 }, { 1000, 1 } };

/// The level of one cell as a function of time.
using Level = std::function<float(Time)>;

float
limited(CueLimiter &limiter, float level, Time time, const CueLimits &limits)
{
  TactileMap map(1, 1);
  map.at(0, 0) = level;
  limiter.limit(map, time, limits);
  const float felt = map.at(0, 0);
  fail_unless(felt == 0 || felt == level, "a level is left as it is or silenced");
  return felt;
}

/// Plays `input` until `end` at `rate`, and checks for each frame whether it passes as `felt`
/// expects.
void
expect(const Level &input, Time end, const CueLimits &limits, const FrameRate &rate,
       const std::function<bool(Time)> &felt)
{
  CueLimiter limiter;
  for (int i = 0; rate.frame(i) < end; ++i) {
    const Time time = rate.frame(i);
    const bool is_felt = limited(limiter, input(time), time, limits) > 0;
    fail_unless(is_felt == (felt(time) && input(time) > 0), "%d: %s at %g s at %g frames/s",
                static_cast<int>(input(time) * 100), is_felt ? "felt" : "not felt",
                std::chrono::duration<double>(time).count(),
                static_cast<double>(rate.numerator) / static_cast<double>(rate.denominator));
  }
}

bool
within(Time time, Time begin, Time end)
{
  return time >= begin && time < end;
}

} // namespace

CHECK_TEST(test_off)
{
  std::mt19937 generator(1);
  std::uniform_real_distribution<float> level(-1, 1);
  CueLimiter limiter;
  Time time{ 0 };
  for (int i = 0; i < 2000; ++i) {
    TactileMap map(3, 4);
    for (float &value : map.levels)
      value = std::max(0.0F, level(generator));
    const TactileMap before = map;
    time += std::chrono::milliseconds(generator() % 300);
    limiter.limit(map, time, {});
    fail_unless(map == before);
  }
}

/// A level that never ends passes for the allowed time, at any rate.
CHECK_TEST(test_duration)
{
  for (const FrameRate &rate : kRates)
    for (const Time allowed : { Time(1ns), Time(250ms), Time(1s), Time(3s) })
      expect([](Time time) { return time >= 400ms ? 0.6F : 0.0F; }, 5s, { .max_duration = allowed },
             rate,
             [&](Time time) {
               // A cue begins with the first frame that shows it.
               int first = 0;
               while (rate.frame(first) < 400ms)
                 ++first;
               return within(time, rate.frame(first), rate.frame(first) + allowed);
             });
}

/// After 100 ms of rest a new cue may begin. A shorter break belongs to the cue.
CHECK_TEST(test_rest)
{
  const auto with_break = [](Time length) {
    return [length](Time time) {
      return within(time, 2s, 2s + length) ? 0.0F : 0.5F;
    };
  };
  const CueLimits limits{ .max_duration = 1s };
  const FrameRate rate{ 1000, 1 };
  expect(with_break(99ms), 4s, limits, rate, [](Time time) { return time < 1s; });
  expect(with_break(100ms), 4s, limits, rate,
         [](Time time) { return time < 1s || within(time, 2100ms, 3100ms); });
  // At 24 fps one frame is too short for a rest, three are long enough.
  expect(with_break(41ms), 4s, limits, { 24, 1 }, [](Time time) { return time < 1s; });
}

/// A flickering level is one cue: it ends after the allowed time, and its breaks start no
/// refractory time.
CHECK_TEST(test_flicker)
{
  for (const FrameRate &rate : { FrameRate{ 24, 1 }, { 30, 1 }, { 60, 1 } }) {
    CueLimiter limiter;
    for (int i = 0; i < 200; ++i) {
      const float level = i % 4 == 3 ? 0.0F : 0.7F;
      const bool felt
          = limited(limiter, level, rate.frame(i), { .max_duration = 1s, .refractory = 500ms }) > 0;
      fail_unless(felt == (level > 0 && rate.frame(i) < 1s), "frame %d", i);
    }
  }
}

/// After a cue has run out, a level 1.5 times the lowest since then begins a new cue of full
/// length. Levels too low to move a motor count as the lowest that does.
CHECK_TEST(test_stronger_event)
{
  const CueLimits limits{ .max_duration = 500ms };
  const auto steps = [](float first, float second, float third) {
    return [=](Time time) {
      return time < 1s ? first : time < 2s ? second : third;
    };
  };
  const auto once = [](Time time) {
    return time < 500ms;
  };
  const auto then = [once](Time begin) {
    return [=](Time time) {
      return once(time) || within(time, begin, begin + 500ms);
    };
  };
  for (const FrameRate &rate : { FrameRate{ 25, 1 }, { 50, 1 }, { 1000, 1 } }) {
    expect(steps(0.5F, 0.74F, 0.74F), 3s, limits, rate, once);
    expect(steps(0.5F, 0.76F, 0.76F), 3s, limits, rate, then(1s));
    expect(steps(0.9F, 0.4F, 0.59F), 3s, limits, rate, once);
    expect(steps(0.9F, 0.4F, 0.61F), 3s, limits, rate, then(2s));
    expect(steps(0.05F, 0.29F, 0.29F), 3s, limits, rate, once);
    expect(steps(0.05F, 0.31F, 0.31F), 3s, limits, rate, then(1s));
    // A rise before the cue has run out belongs to it.
    expect([](Time time) { return time < 400ms ? 0.2F : 1.0F; }, 3s, limits, rate, once);
  }
}

/// No cue begins within the refractory time after another. A level that lasts longer passes from
/// then on.
CHECK_TEST(test_refractory)
{
  // 200 ms of every 500 ms.
  const Level pulses = [](Time time) {
    return time % 500ms < 200ms ? 0.5F : 0.0F;
  };
  for (const FrameRate &rate : { FrameRate{ 20, 1 }, { 50, 1 }, { 1000, 1 } }) {
    expect(pulses, 5s, { .refractory = 1s }, rate, [](Time time) { return time % 1500ms < 200ms; });
    expect(pulses, 5s, { .refractory = 400ms }, rate, [](Time time) {
      // Passes from 0 to 0.2 s, 0.6 to 0.7 s, 1.1 to 1.2 s and so on.
      return time < 200ms || time % 500ms >= 100ms;
    });
    expect(pulses, 5s, { .refractory = 300ms }, rate, [](Time) { return true; });
  }
}

/// A cue that runs out ends then, and its refractory time begins.
CHECK_TEST(test_both)
{
  const CueLimits limits{ .max_duration = 500ms, .refractory = 1s };
  for (const FrameRate &rate : { FrameRate{ 24, 1 }, { 50, 1 }, { 1000, 1 } }) {
    // A rise at 1 s, but the cue ended at 0.5 s.
    expect([](Time time) { return time < 1s ? 0.4F : 0.8F; }, 4s, limits, rate,
           [](Time time) { return time < 500ms || within(time, 1500ms, 2s); });
    // Rest from 0.75 s to 1.25 s.
    expect([](Time time) { return within(time, 750ms, 1250ms) ? 0.0F : 0.4F; }, 4s, limits, rate,
           [](Time time) { return time < 500ms || within(time, 1500ms, 2s); });
  }
  // The cue ends between two frames, at 0.55 s. The next may begin at 1.59 s, so it begins with the
  // frame at 1.6 s.
  expect([](Time time) { return time < 1s ? 0.4F : 0.8F; }, 4s,
         { .max_duration = 550ms, .refractory = 1040ms }, { 10, 1 },
         [](Time time) { return time < 550ms || within(time, 1600ms, 2150ms); });
}

/// At any frame rate a film gives the same result as at 1000 fps, except in frames in which a cue
/// begins or ends.
CHECK_TEST(test_rates_agree)
{
  std::mt19937 generator(7);
  for (int film = 0; film < 20; ++film) {
    // Levels that hold for 0.3 to 1 s. Every third one is zero.
    std::vector<std::pair<Time, float>> steps;
    for (Time time{ 0 }; time < 30s; time += std::chrono::milliseconds(300 + generator() % 700))
      steps.emplace_back(time, generator() % 3 == 0 ? 0.0F : (1 + generator() % 9) / 10.0F);
    const auto level = [&](Time time) {
      const auto next = std::ranges::upper_bound(steps, time, {}, [](auto &s) { return s.first; });
      return std::prev(next)->second;
    };
    const CueLimits limits{ .max_duration = std::chrono::milliseconds(200 + generator() % 900),
                            .refractory = std::chrono::milliseconds(generator() % 900) };
    std::vector<bool> reference;
    CueLimiter fine;
    for (Time time{ 0 }; time < 29s; time += 1ms)
      reference.push_back(limited(fine, level(time), time, limits) > 0);
    CueLimiter coarse;
    int differences = 0;
    int frames = 0;
    for (Time time{ 0 }; time < 29s; time += std::chrono::milliseconds(10 + generator() % 40)) {
      differences += (limited(coarse, level(time), time, limits) > 0)
                     != reference[static_cast<std::size_t>(time / 1ms)];
      frames++;
    }
    // At most two cues a second, each with a beginning and an end.
    fail_unless(differences <= frames / 20, "film %d: %d of %d frames differ", film, differences,
                frames);
  }
}

CHECK_TEST(test_cells_are_independent)
{
  const CueLimits limits{ .max_duration = 500ms, .refractory = 1s };
  CueLimiter limiter;
  CueLimiter alone[4];
  for (int i = 0; i < 300; ++i) {
    const Time time = i * 20ms;
    TactileMap map(2, 2);
    for (int cell = 0; cell < 4; ++cell)
      map.levels[static_cast<std::size_t>(cell)] = i / (10 + 13 * cell) % 2 ? 0.5F : 0.0F;
    const TactileMap before = map;
    limiter.limit(map, time, limits);
    for (std::size_t cell = 0; cell < 4; ++cell)
      fail_unless(map.levels[cell] == limited(alone[cell], before.levels[cell], time, limits));
  }
}

/// A step back in time, another grid and reset() start anew. A repeated time does not.
CHECK_TEST(test_resets)
{
  const CueLimits limits{ .max_duration = 500ms, .refractory = 10s };
  const auto spent = [&](CueLimiter &limiter) {
    fail_unless(limited(limiter, 0.5F, 20s, limits) > 0);
    fail_unless(limited(limiter, 0.5F, 21s, limits) == 0);
    fail_unless(limited(limiter, 0.5F, 21s, limits) == 0);
  };
  CueLimiter back;
  spent(back);
  fail_unless(limited(back, 0.5F, 21s - 1ns, limits) > 0);
  CueLimiter told;
  spent(told);
  told.reset();
  fail_unless(limited(told, 0.5F, 22s, limits) > 0);

  CueLimiter grid;
  TactileMap wide(1, 2);
  TactileMap high(2, 1);
  for (const Time time : { 1s, 2s }) {
    std::ranges::fill(wide.levels, 0.5F);
    grid.limit(wide, time, limits);
  }
  fail_unless(wide.levels[0] == 0 && wide.levels[1] == 0);
  std::ranges::fill(high.levels, 0.5F);
  grid.limit(high, 2s, limits);
  fail_unless(high.levels[0] > 0 && high.levels[1] > 0);

  // Without limits a cue that had run out passes at once.
  CueLimiter freed;
  spent(freed);
  fail_unless(limited(freed, 0.5F, 22s, {}) > 0);
}

/// Times near the ends of their range.
CHECK_TEST(test_extreme_times)
{
  constexpr Time kFar{ 1'000'000'000'000'000'000 };
  CueLimiter limiter;
  fail_unless(limited(limiter, 0.5F, -kFar, { .max_duration = kFar, .refractory = kFar }) > 0);
  fail_unless(limited(limiter, 0.5F, Time(0), { .max_duration = kFar, .refractory = kFar }) == 0);
  fail_unless(limited(limiter, 1.0F, kFar, { .max_duration = kFar, .refractory = kFar }) > 0);
}

CHECK_MAIN(cue_limiter)
