// SPDX-License-Identifier: LGPL-2.1-or-later
#include "race.h"

#include "frame_loop.h"
#include "support/allocations.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <thread>

namespace bench {

namespace {

constexpr double kWarmUpMs = 300;
constexpr std::size_t kWarmUp = 80; // frames: the longest window is 64
constexpr double kSliceMs = 8;
constexpr std::size_t kSlice = 8;
constexpr double kSlowMs = 60;
constexpr int kSlowRounds = 3;
constexpr std::chrono::microseconds kPause{ 33'333 }; // between frames of playback
constexpr std::size_t kPlayedSlice = 4;

double
now(clockid_t clock)
{
  timespec time{};
  clock_gettime(clock, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

struct Times
{
  double cpu = 0;
  double wall = 0;
  double all = 0; ///< threads
};

/// Measures the next frames, beginning at `frame`.
Times
timed(const Contender &contender, std::size_t &frame, std::size_t frames)
{
  Times sum;
  const std::size_t at_once = contender.played ? 1 : frames;
  for (const std::size_t end = frame + frames; frame < end;) {
    if (contender.played)
      std::this_thread::sleep_for(kPause);
    const double cpu = cpu_ms();
    const double wall = wall_ms();
    const double all = now(CLOCK_PROCESS_CPUTIME_ID);
    for (std::size_t n = 0; n < at_once; n++)
      contender.work(frame++);
    sum.wall += wall_ms() - wall;
    sum.cpu += cpu_ms() - cpu;
    sum.all += now(CLOCK_PROCESS_CPUTIME_ID) - all;
  }
  return sum;
}

} // namespace

double
cpu_ms()
{
  return now(CLOCK_THREAD_CPUTIME_ID);
}

double
wall_ms()
{
  return now(CLOCK_MONOTONIC);
}

double
median(std::vector<double> values)
{
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double
ratio(const std::vector<double> &first, const std::vector<double> &second)
{
  std::vector<double> ratios;
  for (std::size_t i = 0; i < std::min(first.size(), second.size()); i++)
    ratios.push_back(first[i] / second[i]);
  return median(ratios);
}

void
race(std::vector<Contender> &contenders, int rounds)
{
  struct Lane
  {
    std::size_t frame = 0;
    std::size_t slice = 1;
    bool slow = false;
    double bytes = 0;
    std::size_t counted = 0;
  };
  std::vector<Lane> lanes(contenders.size());
  const auto run = [&](std::size_t i, std::size_t frames) {
    for (std::size_t n = 0; n < frames; n++)
      contenders[i].work(lanes[i].frame++);
  };

  for (std::size_t i = 0; i < lanes.size(); i++) {
    run(i, 1);
    const double begin = wall_ms();
    run(i, 1);
    const double each = std::max(1e-3, wall_ms() - begin);
    run(i, std::max(contenders[i].history,
                    std::min(kWarmUp, static_cast<std::size_t>(kWarmUpMs / each))));
    lanes[i].slice
        = contenders[i].played
              ? kPlayedSlice
              : std::clamp<std::size_t>(static_cast<std::size_t>(kSliceMs / each), 1, kSlice);
    lanes[i].slow = each > kSlowMs;
  }
  for (int round = 0; round < rounds; round++)
    for (std::size_t i = 0; i < lanes.size(); i++) {
      Lane &lane = lanes[i];
      if (lane.slow && round >= kSlowRounds)
        continue;
      if (!lane.slow)
        run(i, FrameLoop::kBuffers); // so that its own film is in the cache, not another's
      const std::uint64_t before = allocations::bytes_of_all_threads();
      const auto frames = static_cast<double>(lane.slice);
      const Times times = timed(contenders[i], lane.frame, lane.slice);
      contenders[i].wall_ms.push_back(times.wall / frames);
      contenders[i].all_ms.push_back(times.all / frames);
      contenders[i].ms.push_back((contenders[i].threads > 1 ? times.wall : times.cpu) / frames);
      lane.bytes += static_cast<double>(allocations::bytes_of_all_threads() - before);
      lane.counted += lane.slice;
    }
  for (std::size_t i = 0; i < lanes.size(); i++)
    contenders[i].allocated = lanes[i].bytes / static_cast<double>(lanes[i].counted);
}

} // namespace bench
