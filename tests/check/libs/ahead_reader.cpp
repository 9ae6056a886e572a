// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A film that is read ahead of where it plays, on simulated clocks: of the wall and of the CPU.
#include "follow/ahead_reader.h"

#include <algorithm>
#include <cmath>
#include <utility>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace follow;

namespace {

constexpr Time kFrame = 40ms;
constexpr Time kTick = 20ms;
constexpr Time kKeyFrames = 10s;

/// What is seen at a time, so that the right map at the right time shows.
tactile::TactileMap
seen_at(Time time)
{
  tactile::TactileMap map(1, 1);
  map.levels[0] = static_cast<float>(time / kFrame % 1000) / 1000;
  return map;
}

/// A film whose frames cost CPU time, as do those between a key frame and where it is sent.
struct SimulatedFilm : MapSource
{
  Time duration = 60s;
  Time cost = 4ms;        ///< of a frame
  Time cost_unseen = 2ms; ///< of one that is decoded only
  Time position{ 0 };
  Time cpu{ 0 };
  Time until{ 0 }; ///< CPU time that has been worth of waiting
  bool opened = true;
  std::string why{};
  std::vector<std::pair<Time, bool>> seeks{};

  std::optional<tactile::Cue> take() override
  {
    if (position >= duration || cpu + cost > until)
      return std::nullopt;
    cpu += cost;
    const Time begin = std::exchange(position, position + kFrame);
    return tactile::Cue{ .begin = begin, .end = position, .map = seen_at(begin) };
  }
  bool is_ended() const override
  {
    return position >= duration;
  }
  bool is_open() const override
  {
    return opened;
  }
  void seek(Time to, bool exactly) override
  {
    seeks.emplace_back(to, exactly);
    const Time key = to / kKeyFrames * kKeyFrames;
    position = exactly ? to / kFrame * kFrame : key + kKeyFrames;
    if (exactly)
      cpu += (to - key) / kFrame * cost_unseen;
    until = std::max(until, cpu);
  }
  std::string failure() override
  {
    return why;
  }
};

/// Both, and a wall clock. A core does the work as soon as it may.
struct Watched
{
  SimulatedFilm *film;
  AheadReader reader;
  Time now = 1000s;
  Time position{ 0 };

  explicit Watched(std::unique_ptr<SimulatedFilm> source)
      : film(source.get()), reader(std::move(source))
  {
  }

  /// `rate` 0: paused
  void watch(Time span, double rate = 1)
  {
    for (const Time end = now + span; now < end; now += kTick) {
      film->until = std::max(film->until + kTick, film->cpu); // one core
      film->until = std::min(film->until, film->cpu + std::max(kTick, film->cost));
      reader.step(position, now, film->cpu);
      position += Time(std::llround(static_cast<double>(kTick.count()) * rate));
    }
  }
  bool knows(Time time) const
  {
    return reader.draft() && reader.draft()->at(time) != nullptr;
  }
};

void
expect_truth(const tactile::Draft &draft, Time from, Time to)
{
  for (Time time = from; time < to; time += kFrame) {
    const tactile::TactileMap *map = draft.at(time);
    fail_unless(map != nullptr && *map == seen_at(time), "at %.2f s",
                std::chrono::duration<double>(time).count());
  }
}

} // namespace

CHECK_TEST(test_from_the_beginning)
{
  Watched chair(std::make_unique<SimulatedFilm>());
  chair.watch(1s);
  ck_assert(chair.knows(chair.position + 1s));
  chair.watch(30s);
  ck_assert(chair.reader.is_complete() && chair.film->seeks.empty());
  ck_assert(chair.reader.end() == 60s);
  expect_truth(*chair.reader.draft(), 0s, 60s);
  ck_assert(*chair.reader.draft()->at(61s) == tactile::TactileMap(1, 1));
}

/// It is opened in the middle, and sent back.
CHECK_TEST(test_seeks)
{
  auto source = std::make_unique<SimulatedFilm>();
  source->opened = false;
  Watched chair(std::move(source));
  chair.position = 37s;
  chair.watch(200ms);
  ck_assert(chair.film->seeks.empty()); // it cannot yet
  chair.film->opened = true;
  chair.watch(1s);
  ck_assert_uint_eq(chair.film->seeks.size(), 1);
  ck_assert(chair.film->seeks[0].second && chair.film->seeks[0].first >= 37s);
  ck_assert(chair.knows(chair.position) && chair.knows(chair.position + 1s));
  chair.position = 20s;
  chair.watch(1s);
  ck_assert_uint_eq(chair.film->seeks.size(), 2);
  ck_assert(chair.knows(chair.position) && chair.knows(chair.position + 1s));
  // A few seconds ahead of what is read, it is waited for.
  chair.position = chair.reader.known_until(chair.position) + 3s;
  chair.watch(1s);
  ck_assert_uint_eq(chair.film->seeks.size(), 2);
  // In the end all is known, once.
  chair.watch(60s, 0);
  ck_assert(chair.reader.is_complete() && chair.reader.end() == 60s);
  expect_truth(*chair.reader.draft(), 0s, 60s);
}

/// Also after a seek that follows a long time of reading, the place is known as soon as all since
/// the key frame before it is decoded.
CHECK_TEST(test_soon_after_seek)
{
  for (const Time behind : { Time(1s), Time(5s), Time(9500ms) })
    for (const double rate : { 0.0, 1.0 }) {
      auto source = std::make_unique<SimulatedFilm>();
      source->duration = 3600s;
      Watched chair(std::move(source));
      for (const Time key : { 1000s, 500s, 2000s }) {
        chair.watch(10s);
        chair.position = key + behind;
        chair.watch(2s, rate);
        fail_unless(chair.knows(chair.position), "%.1f s behind the key frame at %.0f s, rate %.0f",
                    std::chrono::duration<double>(behind).count(),
                    std::chrono::duration<double>(key).count(), rate);
      }
      fail_if(chair.reader.is_too_slow());
    }
}

/// Over no second of the clock is more CPU time used than is allowed.
CHECK_TEST(test_pace)
{
  auto source = std::make_unique<SimulatedFilm>();
  source->duration = 3600s;
  Watched chair(std::move(source));
  Time before{ 0 };
  for (int second = 0; second < 20; second++) {
    chair.watch(1s);
    const double share = std::chrono::duration<double>(chair.film->cpu - before).count();
    before = chair.film->cpu;
    fail_unless(share <= AheadReader::kUrgentShare + 0.03, "%.2f in second %d", share, second);
    if (second > 2)
      fail_unless(share <= AheadReader::kShare + 0.03, "%.2f in second %d", share, second);
  }
  // At 0.4 of a core, 4 times real time: at most ten minutes ahead.
  chair.watch(600s, 0);
  const Time ahead = chair.reader.known_until(chair.position) - chair.position;
  ck_assert(ahead > AheadReader::kFar && ahead < AheadReader::kFar + 1s);
  before = chair.film->cpu;
  chair.watch(10s, 0);
  ck_assert(chair.film->cpu == before);
}

/// A film that is not decoded in real time: from key frame to key frame, what can be felt is.
CHECK_TEST(test_too_slow)
{
  auto source = std::make_unique<SimulatedFilm>();
  source->duration = 600s;
  source->cost = 60ms;
  source->cost_unseen = 40ms;
  Watched chair(std::move(source));
  chair.watch(2s);
  fail_if(chair.reader.is_too_slow());
  Time felt{ 0 };
  for (Time passed{ 0 }; passed < 120s; passed += 100ms) {
    chair.watch(100ms);
    felt += chair.knows(chair.position) ? Time(100ms) : Time(0);
  }
  ck_assert(chair.reader.is_too_slow());
  fail_unless(felt > 30s, "%.1f s are felt", std::chrono::duration<double>(felt).count());
  fail_if(chair.reader.is_complete());
}

CHECK_TEST(test_fails)
{
  Watched broken(std::make_unique<SimulatedFilm>());
  broken.watch(1s);
  broken.film->why = "broken";
  broken.watch(20ms);
  fail_unless(broken.reader.failure() == "broken");

  auto source = std::make_unique<SimulatedFilm>();
  source->duration = 0s;
  Watched empty(std::move(source));
  empty.position = 30s;
  empty.watch(1s);
  fail_if(empty.reader.failure().empty());
  ck_assert_uint_le(empty.film->seeks.size(), 2);
}

CHECK_MAIN(ahead_reader)
