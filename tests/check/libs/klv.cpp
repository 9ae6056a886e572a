// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/klv.h"

#include "track_samples.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactile;

CHECK_TEST(test_bytes)
{
  // By hand from the table in klv.h.
  const std::vector<std::uint8_t> expected
      = { 0x06, 0x0e, 0x2b, 0x34, 0x02, 0x05, 0x01, 0x01, 0x0f, 'T', 'A', 'C',
          'T',  'I',  'L',  'E',  19,   1,    1,    2,    0,    0,   0,   0,
          0x3b, 0x9a, 0xca, 0x00, 0x3f, 0x40, 0x00, 0x00, 0,    0,   0,   0 };
  fail_unless(write_klv(make_map(1, 2, { 0.75F, 0 }), 1s) == expected);
}

CHECK_TEST(test_round_trip)
{
  for (unsigned seed = 0; seed < 50; seed++) {
    const Track track = random_track(seed, 1ms, 0);
    for (const Track::Entry &entry : track.entries()) {
      const Cue cue = *read_klv(write_klv(entry.map, entry.time));
      fail_unless(cue.map == entry.map && cue.begin == 0s && cue.end == entry.time);
    }
  }
  const TactileMap large(64, 64); // its length takes two bytes
  fail_unless(read_klv(write_klv(large, 1s))->map == large);
}

CHECK_TEST(test_frequency)
{
  TactileMap map(1, 2);
  map.levels = { 0.5F, 1 };
  map.frequency = 120;
  std::vector<std::uint8_t> bytes = write_klv(map, 20ms);
  fail_unless(bytes[17] == 2 && bytes.size() == 17 + 11 + 3 * 4);
  fail_unless(read_klv(bytes)->map == map);
  bytes[bytes.size() - 4] = 0x7f;
  ASSERT_COMPLAINT(read_klv(bytes), "byte 36", "1 to 1000 Hz");
}

CHECK_TEST(test_refused)
{
  const std::vector<std::uint8_t> good = write_klv(make_map(1, 2, { 0.75F, 0 }), 1s);
  const auto with = [&](std::size_t at, std::uint8_t value) {
    std::vector<std::uint8_t> bytes = good;
    bytes[at] = value;
    return bytes;
  };
  ASSERT_COMPLAINT(read_klv({}), "byte 0", "another key");
  ASSERT_COMPLAINT(read_klv(with(15, 'X')), "byte 0", "another key");
  for (std::size_t size = 16; size < good.size(); size++)
    ASSERT_COMPLAINT(read_klv(std::span(good).first(size)), "byte", "");
  std::vector<std::uint8_t> longer = good;
  longer.push_back(0);
  ASSERT_COMPLAINT(read_klv(longer), "byte 17", "value of 19 bytes, got 20");
  ASSERT_COMPLAINT(read_klv(with(16, 20)), "byte 17", "value of 20 bytes, got 19");
  ASSERT_COMPLAINT(read_klv(with(16, 0x80)), "byte 16", "BER");
  ASSERT_COMPLAINT(read_klv(with(16, 0xff)), "byte 16", "BER");
  ASSERT_COMPLAINT(read_klv(with(16, 0x88)), "byte", "");
  ASSERT_COMPLAINT(read_klv(with(17, 3)), "byte 17", "version");
  ASSERT_COMPLAINT(read_klv(with(17, 2)), "byte 28", "levels"); // and a frequency
  ASSERT_COMPLAINT(read_klv(with(18, 0)), "byte 18", "rows");
  ASSERT_COMPLAINT(read_klv(with(19, 65)), "byte 18", "rows");
  ASSERT_COMPLAINT(read_klv(with(19, 3)), "byte 28", "3 levels");
  ASSERT_COMPLAINT(read_klv(with(20, 0xff)), "byte 20", "100 hours");
  ASSERT_COMPLAINT(read_klv(with(28, 0x7f)), "byte 28", "0 to 1"); // too large
  ASSERT_COMPLAINT(read_klv(with(28, 0xbf)), "byte 28", "0 to 1"); // negative
  std::vector<std::uint8_t> nan = with(28, 0x7f);
  nan[29] = 0xc0;
  ASSERT_COMPLAINT(read_klv(nan), "byte 28", "0 to 1");
}

CHECK_MAIN(klv)
