// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/track_edit.h"

#include <functional>

#include "track_samples.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactile;

namespace {

/// Two cells and 6 s. The first has level 0.2 from 1 s to 1.1 s and 0.8 from 2 s to 4 s, the second
/// 0.5 from 3 s to 5 s.
Track
sample()
{
  Track track(1, 2);
  track.append(1000ms, make_map(1, 2, { 0.2F, 0 }));
  track.append(1100ms, make_map(1, 2, { 0, 0 }));
  track.append(2000ms, make_map(1, 2, { 0.8F, 0 }));
  track.append(3000ms, make_map(1, 2, { 0.8F, 0.5F }));
  track.append(4000ms, make_map(1, 2, { 0, 0.5F }));
  track.append(5000ms, make_map(1, 2, { 0, 0 }));
  track.set_end(6000ms);
  return track;
}

/// Compares levels every 5 ms, whatever the track's entries are.
void
assert_course(const Track &track, Time end, const std::function<TactileMap(Time)> &expected)
{
  fail_unless(track.end() == end, "it ends at %g s",
              std::chrono::duration<double>(track.end()).count());
  for (Time time{ 0 }; time < end; time += 5ms) {
    const TactileMap &map = track.at(time);
    const TactileMap wanted = expected(time);
    for (std::size_t i = 0; i < map.levels.size(); i++)
      fail_unless(std::abs(map.levels[i] - wanted.levels[i]) < 1e-6F,
                  "at %g s cell %zu is %g instead of %g",
                  std::chrono::duration<double>(time).count(), i,
                  static_cast<double>(map.levels[i]), static_cast<double>(wanted.levels[i]));
  }
}

} // namespace

CHECK_TEST(test_prune)
{
  assert_course(prune_short(sample(), 101ms), 6s, [](Time time) {
    TactileMap map = sample().at(time);
    if (time < 2s)
      map.levels[0] = 0;
    return map;
  });
  fail_unless(prune_short(sample(), 100ms) == sample());
  assert_course(prune_short(sample(), 3s), 6s, [](Time) { return TactileMap(1, 2); });
  assert_course(prune_weak(sample(), 0.6F), 6s, [](Time time) {
    TactileMap map = sample().at(time);
    map.levels[1] = 0;
    if (time < 2s)
      map.levels[0] = 0;
    return map;
  });
  fail_unless(prune_weak(sample(), 0.2F) == sample());
}

CHECK_TEST(test_merge)
{
  Track track(1, 1);
  track.append(0s, make_map(1, 1, { 0.5F }));
  track.append(1s, make_map(1, 1, { 0.54F }));
  track.append(2s, make_map(1, 1, { 0.58F })); // too far from the first
  track.append(3s, make_map(1, 1, { 0.02F }));
  track.append(4s, make_map(1, 1, { 0 })); // silence remains
  track.set_end(5s);
  Track expected(1, 1);
  expected.append(0s, make_map(1, 1, { 0.5F }));
  expected.append(2s, make_map(1, 1, { 0.58F }));
  expected.append(3s, make_map(1, 1, { 0.02F }));
  expected.append(4s, make_map(1, 1, { 0 }));
  expected.set_end(5s);
  fail_unless(merge_equal(track, 0.05F) == expected);
  fail_unless(merge_equal(track, 0) == track);
}

CHECK_TEST(test_limit)
{
  // At most one second, then half a second of rest. The second cell's event is not delayed.
  assert_course(*limit_events(sample(), { .max_duration = 1s, .refractory = 500ms }), 6s,
                [](Time time) {
                  TactileMap map = sample().at(time);
                  if (time >= 3s)
                    map.levels[0] = 0;
                  if (time >= 4s)
                    map.levels[1] = 0;
                  return map;
                });
  fail_unless(limit_events(sample(), {}) == sample());
}

CHECK_TEST(test_shift_and_clip)
{
  assert_course(*shift(sample(), 250ms), 6250ms,
                [](Time time) { return sample().at(time - 250ms); });
  assert_course(*shift(sample(), -2500ms), 3500ms,
                [](Time time) { return sample().at(time + 2500ms); });
  fail_unless(shift(*shift(sample(), 1s), -1s) == sample());
  fail_unless(shift(sample(), -10s) == Track(1, 2));
  assert_course(*clip(sample(), 2500ms, 4500ms), 2s,
                [](Time time) { return sample().at(time + 2500ms); });
  fail_unless(clip(sample(), 0s, 100h) == sample());
  assert_course(*silence(sample(), 2500ms, 3500ms), 6s, [](Time time) {
    return time >= 2500ms && time < 3500ms ? TactileMap(1, 2) : sample().at(time);
  });
  assert_course(*silence(sample(), 0s, 10s), 6s, [](Time) { return TactileMap(1, 2); });
}

CHECK_TEST(test_levels)
{
  assert_course(scale(sample(), 1.5F), 6s, [](Time time) {
    TactileMap map = sample().at(time);
    for (float &level : map.levels)
      level = std::min(level * 1.5F, 1.0F);
    return map;
  });
  assert_course(mask(sample(), { 0, 7, -1 }), 6s, [](Time time) {
    TactileMap map = sample().at(time);
    map.levels[0] = 0;
    return map;
  });
  assert_course(quantize(sample(), 2), 6s, [](Time time) {
    TactileMap map = sample().at(time);
    for (float &level : map.levels)
      level = level < 0.25F ? 0.0F : level < 0.75F ? 0.5F : 1.0F;
    return map;
  });
}

CHECK_TEST(test_resample)
{
  // To a common multiple of both grids and back to the mean, cell by cell: a second way to compute
  // the area.
  const TactileMap map = random_track(3, 1ms, 0).entries()[1].map;
  for (const auto &[rows, columns] :
       { std::pair{ 1, 1 }, { 2, 3 }, { 5, 4 }, { 8, 8 }, { 64, 1 } }) {
    const TactileMap result = resample(map, rows, columns);
    for (int r = 0; r < rows; r++)
      for (int c = 0; c < columns; c++) {
        double sum = 0;
        for (int y = r * map.rows; y < (r + 1) * map.rows; y++)
          for (int x = c * map.columns; x < (c + 1) * map.columns; x++)
            sum += static_cast<double>(map.at(y / rows, x / columns));
        fail_unless(std::abs(static_cast<double>(result.at(r, c)) - sum / (map.rows * map.columns))
                    < 1e-6);
      }
  }
  fail_unless(resample(sample(), 1, 2) == sample());
  const Track coarse = *resample(sample(), 1, 1);
  fail_unless_equals_float(coarse.at(3s).at(0, 0), 0.65);
  fail_unless(coarse.end() == 6s);
}

CHECK_TEST(test_mix)
{
  const auto mixed
      = [](std::initializer_list<float> map, std::initializer_list<float> over, Mix mix) {
          TactileMap result = make_map(1, 2, map);
          mix_into(result, make_map(1, 2, over), mix);
          return result;
        };
  fail_unless(mixed({ 0.25F, 0.5F }, { 0.5F, 0 }, Mix::sum) == make_map(1, 2, { 0.75F, 0.5F }));
  fail_unless(mixed({ 0.75F, 0 }, { 0.5F, 0 }, Mix::sum) == make_map(1, 2, { 1, 0 }));
  // The strength of the second at the first's place.
  fail_unless(mixed({ 0.25F, 0.5F }, { 1, 0 }, Mix::gate) == make_map(1, 2, { 0.5F, 1 }));
  fail_unless(mixed({ 0.25F, 0.5F }, { 0, 0 }, Mix::gate) == make_map(1, 2, { 0, 0 }));
  fail_unless(mixed({ 0, 0 }, { 0.5F, 0.25F }, Mix::gate) == make_map(1, 2, { 0.5F, 0.25F }));
}

CHECK_TEST(test_overlay_and_diff)
{
  Track over(1, 2);
  over.append(2500ms, make_map(1, 2, { 0.1F, 1 }));
  over.append(7s, make_map(1, 2, { 0, 0 }));
  over.set_end(8s);
  const Track strongest = *overlay(sample(), over, Mix::max);
  assert_course(strongest, 8s, [&](Time time) {
    TactileMap map = sample().at(time);
    for (std::size_t i = 0; i < 2; i++)
      map.levels[i] = std::max(map.levels[i], over.at(time).levels[i]);
    return map;
  });
  const Track replaced = *overlay(sample(), over, Mix::replace);
  assert_course(replaced, 8s, [&](Time time) {
    return time >= 2500ms && time < 7s ? over.at(time) : sample().at(time);
  });

  // Applying what diff() returns to the first track gives the second.
  const std::vector<Difference> differences = *diff(sample(), strongest);
  fail_if(differences.empty());
  for (Time time{ 0 }; time < 8s; time += 5ms) {
    TactileMap map = sample().at(time);
    for (const Difference &difference : differences)
      if (difference.begin <= time && time < difference.end) {
        fail_unless(map == difference.before);
        map = difference.after;
      }
    fail_unless(map == strongest.at(time));
  }
  fail_unless(diff(sample(), sample())->empty());
  fail_unless(diff(sample(), scale(sample(), 0.99F), 0.02F)->empty());
  fail_if(diff(sample(), Track(2, 2)));
  fail_if(shift(sample(), Track::kMaxEnd));
  fail_if(clip(sample(), -Track::kMaxEnd, 6s));
}

CHECK_MAIN(track_edit)
