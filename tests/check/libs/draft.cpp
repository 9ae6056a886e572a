// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A track that is written in any order, against one map for each millisecond.
#include "tracks/draft.h"

#include "random.h"

#include <algorithm>
#include <array>
#include <optional>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactile;

namespace {

constexpr int kMilliseconds = 200;

TactileMap
map_of(int level)
{
  TactileMap map(1, 2);
  map.levels = { static_cast<float>(level) / 4, 0.5F };
  return map;
}

Time
ms(int milliseconds)
{
  return std::chrono::milliseconds(milliseconds);
}

} // namespace

CHECK_TEST(test_any_order)
{
  visuotactile::Random random(7);
  for (int round = 0; round < 200; round++) {
    Draft draft(1, 2);
    std::array<std::optional<int>, kMilliseconds + 1> truth{};
    for (int step = 0; step < 30; step++) {
      const int begin = random.below(kMilliseconds);
      const int end = std::min(begin + random.below(30), kMilliseconds);
      const int level = random.below(4);
      fail_unless(draft.set(ms(begin), ms(end), map_of(level)).has_value());
      for (int i = begin; i < end; i++)
        truth[i] = level;
    }
    Time changes_at = Time::max();
    int known_until = kMilliseconds;
    for (int i = kMilliseconds - 1; i >= 0; i--) {
      if (truth[i] != truth[i + 1])
        changes_at = ms(i + 1);
      if (!truth[i])
        known_until = i;
      const TactileMap *map = draft.at(ms(i));
      ck_assert(truth[i].has_value() == (map != nullptr));
      fail_unless(map == nullptr || *map == map_of(*truth[i]), "round %d at %d ms", round, i);
      ck_assert(draft.known_until(ms(i)) == ms(known_until));
      ck_assert(draft.until(ms(i)) == changes_at);
    }
    fail_if(draft.at(ms(kMilliseconds)) != nullptr);
  }
}

CHECK_TEST(test_of_a_track)
{
  Track track(1, 2);
  fail_unless(track.append(10ms, map_of(3)).has_value());
  fail_unless(track.set_end(50ms).has_value());
  const Draft whole(track);
  ck_assert(*whole.at(0ms) == TactileMap(1, 2) && *whole.at(10ms) == map_of(3));
  ck_assert(*whole.at(50ms) == TactileMap(1, 2));
  ck_assert(whole.until(10ms) == 50ms && whole.until(50ms) == Time::max());
  ck_assert(whole.known_until(0ms) == Time::max());
  ck_assert(*whole.at(-1s) == *whole.at(0ms));
  Track again = whole.track(50ms, 0);
  ck_assert(again == track);
}

CHECK_TEST(test_what_is_unknown_is_silent)
{
  Draft draft(1, 2);
  fail_unless(draft.set(10ms, 20ms, map_of(1)).has_value());
  fail_unless(draft.set(30ms, 40ms, map_of(2)).has_value());
  const Track track = draft.track(100ms, 5);
  ck_assert(track.at(15ms) == map_of(1) && track.at(35ms) == map_of(2));
  ck_assert(track.at(5ms) == TactileMap(1, 2) && track.at(25ms) == TactileMap(1, 2));
  ck_assert(track.end() == 100ms && track.rate() == 5);
}

CHECK_TEST(test_refuses)
{
  Draft draft(1, 2);
  fail_unless(draft.set(10ms, 20ms, map_of(1)).has_value());
  fail_if(draft.set(10ms, 20ms, TactileMap(2, 1)).has_value());
  fail_if(draft.set(-1ms, 20ms, map_of(2)).has_value());
  fail_if(draft.set(10ms, Track::kMaxEnd + 1ns, map_of(2)).has_value());
  fail_unless(draft.set(15ms, 15ms, map_of(2)).has_value());
  fail_unless(draft.set(15ms, 5ms, map_of(2)).has_value());
  ck_assert(*draft.at(15ms) == map_of(1) && draft.until(10ms) == 20ms);
}

CHECK_MAIN(draft)
