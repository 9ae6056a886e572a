// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/track.h"

#include "track_samples.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactile;

CHECK_TEST(test_empty)
{
  const Track track(2, 3);
  fail_unless(track.rows() == 2 && track.columns() == 3);
  fail_unless(track.end() == 0s && track.entries().size() == 1);
  fail_unless(is_silent(track.at(0s)) && is_silent(track.at(-1s)) && is_silent(track.at(1h)));
}

CHECK_TEST(test_maps_hold_until_the_next)
{
  const Track track = two_tactors();
  fail_unless_equals_int(track.entries().size(), 2);
  fail_unless(is_silent(track.at(1000ms - 1ns)));
  fail_unless_equals_float(track.at(1000ms).at(1, 1), 0.75);
  fail_unless_equals_float(track.at(1400ms - 1ns).at(1, 2), 0.75);
  fail_unless(is_silent(track.at(1400ms)));
}

CHECK_TEST(test_canonical_form)
{
  const TactileMap a = make_map(1, 2, { 0.5F, 0 });
  const TactileMap b = make_map(1, 2, { 0, 1 });
  Track track(1, 2);
  track.append(0s, a);
  track.append(1s, a); // unchanged
  track.append(2s, b);
  track.append(2s, a); // replaces b: unchanged again
  track.append(3s, b);
  track.set_end(3s); // b is cut off
  Track same(1, 2);
  same.append(0s, a);
  same.set_end(3s);
  fail_unless(track == same);
  fail_unless_equals_int(track.entries().size(), 1);
  same.set_end(0s);
  fail_unless(same == Track(1, 2));
}

CHECK_TEST(test_refused)
{
  Track track(1, 1);
  const TactileMap map = make_map(1, 1, { 1 });
  track.append(2s, map);
  fail_if(track.append(1s, map));
  fail_if(track.append(Track::kMaxEnd + 1ns, map));
  fail_if(track.append(3s, TactileMap(1, 2)));
  fail_if(track.set_end(-1ns));
  fail_if(track.set_end(Track::kMaxEnd + 1ns));
  fail_unless(track.append(Track::kMaxEnd, TactileMap(1, 1)));
}

CHECK_TEST(test_resolution)
{
  Track track(1, 1);
  track.append(1'999'999ns, make_map(1, 1, { 0.124F }));
  track.append(2'500'000ns, make_map(1, 1, { 0.126F }));
  track.append(9'000'000ns, make_map(1, 1, { 0.9F }));
  track.set_end(9'900'000ns);
  Track expected(1, 1);
  expected.append(1ms, make_map(1, 1, { 0.12F }));
  expected.append(2ms, make_map(1, 1, { 0.13F }));
  expected.set_end(9ms); // the last map is shorter than a tick
  fail_unless(at_resolution(track, 1ms, 100) == expected);
  fail_unless(at_resolution(track, 1ns, 0) == track);
}

CHECK_MAIN(track)
