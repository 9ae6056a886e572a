// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/csv.h"

#include "track_samples.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactile;

CHECK_TEST(test_text)
{
  Track track(1, 2);
  track.set_rate(5);
  track.append(1000ms, make_map(1, 2, { 0.75F, 0.1F }));
  track.append(1033'366'700ns, make_map(1, 2, { 0, 1 }));
  track.set_end(1400ms);
  ASSERT_TEXT(write_csv(track), "# tactile grid=1x2 rate=5\n"
                                "time_ms,t0,t1\n"
                                "0,0,0\n"
                                "1000,0.75,0.1\n"
                                "1033.3667,0,1\n"
                                "1400,0,0\n");
}

CHECK_TEST(test_exact_round_trip)
{
  for (unsigned seed = 0; seed < 200; seed++) {
    const Track track = random_track(seed, Time(16'683'333), 0);
    fail_unless(read_csv(write_csv(track)) == track, "seed %u", seed);
  }
  const Track empty(64, 64);
  fail_unless(read_csv(write_csv(empty)) == empty);
}

CHECK_TEST(test_text_from_spreadsheets)
{
  fail_unless(read_csv("\xef\xbb\xbf# tactile grid=1x2,,\r\ntime_ms,t0,t1\r\n0,0.50, 0\r\n100.0, "
                       "0,0\r\n,,\r\n")
              == [] {
                   Track track(1, 2);
                   track.append(0s, make_map(1, 2, { 0.5F, 0 }));
                   track.set_end(100ms);
                   return track;
                 }());
}

CHECK_TEST(test_refused)
{
  const auto read = [](const std::string &rest) {
    return read_csv("# tactile grid=1x2 rate=5\ntime_ms,t0,t1\n" + rest);
  };
  ASSERT_COMPLAINT(read_csv(""), "line 1", "# tactile");
  ASSERT_COMPLAINT(read_csv("time_ms,t0\n"), "line 1", "# tactile");
  ASSERT_COMPLAINT(read_csv("# tactile rate=5\n"), "line 1", "grid");
  ASSERT_COMPLAINT(read_csv("# tactile grid=1x3\ntime_ms,t0,t1\n"), "line 2", "t0 to t2");
  ASSERT_COMPLAINT(read_csv("# tactile grid=1x2\ntime_ms;t0;t1\n"), "line 2", "commas");
  ASSERT_COMPLAINT(read(""), "line 2", "ends the track");
  ASSERT_COMPLAINT(read("0,0,0\n10,1,0\n"), "line 4", "levels of 0");
  ASSERT_COMPLAINT(read("0,0,0\n0,1,0\n"), "line 4", "not after");
  ASSERT_COMPLAINT(read("0,0\n"), "line 3", "2 levels");
  ASSERT_COMPLAINT(read("0,0,0,1\n"), "line 3", "more levels");
  ASSERT_COMPLAINT(read("0,0,1.5\n"), "line 3", "'1.5'");
  ASSERT_COMPLAINT(read("0,0,nan\n"), "line 3", "'nan'");
  ASSERT_COMPLAINT(read("0,0,-1\n"), "line 3", "'-1'");
  ASSERT_COMPLAINT(read("-1,0,0\n"), "line 3", "time");
  ASSERT_COMPLAINT(read("1e3,0,0\n"), "line 3", "time");
  ASSERT_COMPLAINT(read("1.,0,0\n"), "line 3", "time");
  ASSERT_COMPLAINT(read("0.0000001,0,0\n"), "line 3", "time"); // finer than a nanosecond
  ASSERT_COMPLAINT(read("99999999999999999999,0,0\n"), "line 3", "time");
  ASSERT_COMPLAINT(read("360000001,0,0\n"), "line 3", "100 hours");
}

CHECK_MAIN(csv)
