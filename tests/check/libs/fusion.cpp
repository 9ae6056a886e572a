// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/fusion.h"

#include <algorithm>
#include <initializer_list>
#include <set>
#include <string>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

using fusion::Fusion;
using fusion::SoundMap;
using fusion::SoundMaps;
using tactile::Mix;
using tactile::TactileMap;
using namespace std::chrono_literals;

namespace {

TactileMap
map_of(std::initializer_list<float> levels)
{
  TactileMap map(1, static_cast<int>(levels.size()));
  map.levels = levels;
  return map;
}

} // namespace

// What is seen stays where it is, and is as strong as what is heard.
CHECK_TEST(test_mixes)
{
  const auto mixed = [](TactileMap picture, TactileMap sound, Mix mix) {
    return Fusion().mix(0ms, 40ms, picture, sound, mix);
  };
  const TactileMap seen = map_of({ 0.25F, 0.5F });
  fail_unless(mixed(seen, map_of({ 1, 0 }), Mix::accent) == map_of({ 0.5F, 1 }));
  fail_unless(mixed(seen, map_of({ 0.25F, 0 }), Mix::accent) == seen);
  fail_unless(mixed(seen, map_of({ 1, 0 }), Mix::stress) == map_of({ 0.5F, 1 }));
  fail_unless(mixed(map_of({ 0, 0 }), map_of({ 1, 0 }), Mix::accent) == map_of({ 1, 0 }));
  fail_unless(mixed(map_of({ 0, 0 }), map_of({ 1, 0 }), Mix::stress) == map_of({ 0, 0 }));
  fail_unless(mixed(seen, map_of({ 1, 0 }), Mix::replace) == map_of({ 1, 0 }));
  fail_unless(mixed(seen, map_of({ 0, 0 }), Mix::replace) == map_of({ 0, 0 }));
  fail_unless(mixed(seen, map_of({ 1 }), Mix::max) == map_of({ 1, 1 })); // another grid
  fail_unless(mixed(seen, {}, Mix::accent) == seen);                     // silence without cells
}

// An impact is felt where its picture was up to 250 ms before, or will be.
CHECK_TEST(test_one_place)
{
  const TactileMap none = map_of({ 0, 0 });
  const TactileMap left = map_of({ 0.5F, 0 });
  const TactileMap right = map_of({ 0, 1 });
  for (const Mix mix : { Mix::accent, Mix::stress, Mix::gate }) {
    Fusion fusion;
    fusion.mix(0ms, 40ms, left, none, mix);
    fail_unless(fusion.mix(40ms, 80ms, none, right, mix) == map_of({ 1, 0 }));
    fail_unless(fusion.mix(290ms, 330ms, none, right, mix) == map_of({ 1, 0 }));
    fail_unless(fusion.mix(291ms, 330ms, none, none, mix) == none);
    const TactileMap unseen = mix == Mix::stress ? none : right;
    fail_unless(fusion.mix(291ms, 330ms, none, right, mix) == unseen);
    fail_unless(fusion.mix(400ms, 440ms, none, right, mix, &left) == map_of({ 1, 0 }));
    fusion.mix(440ms, 480ms, left, none, mix);
    fusion.reset();
    fail_unless(fusion.mix(480ms, 520ms, none, right, mix) == unseen);
  }
}

CHECK_TEST(test_pieces)
{
  const auto at = [](int begin, int end, float level) {
    return SoundMap{ std::chrono::milliseconds(begin), std::chrono::milliseconds(end),
                     map_of({ level }) };
  };
  // Silence, an onset that begins anew, and what is a little louder.
  const std::vector<SoundMap> frame
      = { at(90, 105, 0.1F), at(120, 130, 0.5F), at(130, 140, 0.6F), at(140, 150, 0.9F) };
  const auto pieces = fusion::pieces(100ms, 145ms, frame);
  ck_assert_uint_eq(pieces.size(), 3);
  fail_unless(pieces[0].begin == 100ms && pieces[0].end == 120ms
              && pieces[0].map == map_of({ 0.1F }));
  fail_unless(pieces[1].begin == 120ms && pieces[1].end == 140ms
              && pieces[1].map == map_of({ 0.6F }));
  fail_unless(pieces[2].begin == 140ms && pieces[2].end == 145ms
              && pieces[2].map == map_of({ 0.9F }));
  // A long frame has a piece every 50 ms or so, silence none of its own.
  const auto silent = fusion::pieces(0ms, 40ms, {});
  fail_unless(silent.size() == 1 && silent[0].end == 40ms && silent[0].map.levels.empty());
  std::vector<SoundMap> roll;
  for (int i = 0; i < 100; i++)
    roll.push_back(at(10 * i, 10 * i + 10, 0.5F));
  ck_assert_uint_eq(fusion::pieces(0ms, 1000ms, roll).size(), 20);
  const auto moment = fusion::pieces(7ms, 7ms, std::span(roll).first(1));
  fail_unless(moment.front().map == map_of({ 0.5F }));
}

CHECK_TEST(test_sound_maps)
{
  SoundMaps maps;
  const auto add = [&](int begin, int end, float level) {
    maps.add(&maps, { std::chrono::milliseconds(begin), std::chrono::milliseconds(end),
                      map_of({ level }) });
  };
  fail_if(maps.is_heard());
  add(0, 10, 1);
  fail_unless(maps.between(0ms, 100ms).empty()); // of nobody who hears
  fail_unless(maps.hear(&maps, true));
  fail_unless(maps.is_heard() && !maps.hear(&maps, true));
  add(0, 10, 1);
  add(10, 20, 0); // silent
  add(20, 30, 0.5F);
  fail_unless(maps.between(0ms, 100ms).size() == 2);
  fail_unless(maps.between(10ms, 20ms).empty());
  fail_unless(maps.between(29ms, 30ms).size() == 1 && maps.between(30ms, 40ms).empty());
  // Another track from 5 ms on.
  add(5, 8, 0.25F);
  const auto now = maps.between(0ms, 100ms);
  fail_unless(now.size() == 2 && now[0].end == 5ms && now[1].map == map_of({ 0.25F }));
  maps.forget(&maps);
  fail_unless(maps.between(0ms, 100ms).empty() && maps.is_heard());
  // Bounded: the oldest go.
  for (int i = 0; i < 2000; i++)
    add(i, i + 1, 1);
  ck_assert_uint_eq(maps.between(0ms, 2000ms).size(), SoundMaps::kMost);
  fail_unless(maps.between(1999ms, 2000ms).size() == 1);
  fail_unless(maps.hear(&maps, false));
  fail_unless(maps.between(0ms, 2000ms).empty());
}

// Of two that hear, none speaks for the other.
CHECK_TEST(test_two_sounds)
{
  SoundMaps maps;
  const int who[2] = {};
  fail_unless(maps.hear(&who[0], true) && !maps.hear(&who[1], true));
  maps.add(&who[0], { 0ms, 20ms, map_of({ 0.5F, 0.25F }) });
  maps.add(&who[1], { 10ms, 30ms, map_of({ 0.25F, 0.75F }) });
  maps.add(&who[1], { 40ms, 50ms, map_of({ 1, 0 }) });
  const auto both = maps.between(0ms, 100ms);
  const SoundMap expected[] = { { 0ms, 10ms, map_of({ 0.5F, 0.25F }) },
                                { 10ms, 20ms, map_of({ 0.5F, 0.75F }) },
                                { 20ms, 30ms, map_of({ 0.25F, 0.75F }) },
                                { 40ms, 50ms, map_of({ 1, 0 }) } };
  fail_unless(std::ranges::equal(both, expected, [](const SoundMap &a, const SoundMap &b) {
    return a.begin == b.begin && a.end == b.end && a.map == b.map;
  }));
  maps.forget(&who[0]);
  ck_assert_uint_eq(maps.between(0ms, 100ms).size(), 2);
  fail_if(maps.hear(&who[1], false));
  fail_unless(maps.is_heard() && maps.between(0ms, 100ms).empty());
  fail_unless(maps.hear(&who[0], false) && !maps.is_heard());
}

// Who feels the sound says how; the last one counts.
CHECK_TEST(test_wanted)
{
  SoundMaps maps;
  const int readers[2] = {};
  const fusion::Profile *film = fusion::find_profile("film");
  const fusion::Profile *music = fusion::find_profile("music");
  fail_unless(film == &fusion::profiles()[0] && music && !fusion::find_profile("off"));
  fail_unless(maps.wanted() == nullptr);
  maps.want(&readers[0], film);
  maps.want(&readers[1], music);
  fail_unless(maps.wanted() == music);
  maps.want(&readers[1], nullptr);
  fail_unless(maps.wanted() == film);
  maps.want(&readers[0], music);
  fail_unless(maps.wanted() == music);
  maps.want(&readers[0], nullptr);
  fail_unless(maps.wanted() == nullptr);
  std::set<std::string> names;
  for (const fusion::Profile &profile : fusion::profiles())
    names.insert(profile.name);
  const std::set<std::string> expected{ "film", "music", "dialogue-heavy", "bass-shaker" };
  fail_unless(names == expected);
}

CHECK_MAIN(fusion)
