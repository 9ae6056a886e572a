// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/text_cue.h"

#include "tracks/cue_builder.h"

#include "track_samples.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactile;

CHECK_TEST(test_picture)
{
  const std::string text = write_text_cue(two_tactors().at(1s));
  ASSERT_TEXT(text, "  0   0   0\n  0  75  75\n  0   0   0");
  fail_unless(read_text_cue(text, std::nullopt) == two_tactors().at(1s));
  ASSERT_TEXT(write_text_cue(make_map(1, 2, { 1, 0.004F })), "100   0");
}

CHECK_TEST(test_all_grids_and_percents)
{
  for (int rows = 1; rows <= 64; rows += 9)
    for (int columns = 1; columns <= 64; columns += 7) {
      TactileMap map(rows, columns);
      for (std::size_t i = 0; i < map.levels.size(); i++)
        map.levels[i] = static_cast<float>(i % 101) / 100;
      const std::string text = write_text_cue(map);
      fail_unless(read_text_cue(text, std::nullopt) == map);
      fail_unless(read_text_cue(text, Grid{ rows, columns }) == map);
      fail_unless(text.find_first_of("<>&\"") == std::string::npos);
    }
}

CHECK_TEST(test_white_space_and_percent_signs)
{
  const TactileMap map = make_map(2, 2, { 0, 1, 0.25F, 0.5F });
  for (const char *text : { "0 100\n25 50", "\n\n 0\t100 \r\n25  50\r\n\n", "0% 100%\n25% 50%",
                            "\u00a00\u00a0100\n\u00a025\u00a050\u00a0", "0 100.0\n25.00 50" })
    fail_unless(read_text_cue(text, std::nullopt) == map, "%s", text);
  // Without a header, but with a known grid, lines may be broken anywhere, as some containers do.
  fail_unless(read_text_cue("0 100 25 50", Grid{ 2, 2 }) == map);
  fail_unless(read_text_cue("0\n100\n25\n50", Grid{ 2, 2 }) == map);
}

CHECK_TEST(test_refused)
{
  const auto read = [](std::string_view text, std::optional<Grid> grid = std::nullopt) {
    return read_text_cue(text, grid, 7);
  };
  ASSERT_COMPLAINT(read(""), "line 7", "nothing");
  ASSERT_COMPLAINT(read("1 2\n3 101"), "line 8", "0 to 100");
  ASSERT_COMPLAINT(read("-1"), "line 7", "'-1'");
  ASSERT_COMPLAINT(read("nan"), "line 7", "0 to 100");
  ASSERT_COMPLAINT(read("1e1"), "line 7", "white space");
  ASSERT_COMPLAINT(read("1 2\n3"), "line 8", "as in the rows before");
  ASSERT_COMPLAINT(read("1 2\n3 4", Grid{ 3, 3 }), "line 7", "9 levels for a grid of 3x3, got 4");
  ASSERT_COMPLAINT(read("Hello, world"), "line 7", "'Hello,'");
  ASSERT_COMPLAINT(read("<b>1</b>"), "line 7", "0 to 100");
  std::string row;
  for (int i = 0; i < 65; i++)
    row += "1 ";
  ASSERT_COMPLAINT(read(row), "line 7", "at most 64");
  std::string many;
  for (int i = 0; i < 5000; i++)
    many += "1\n";
  ASSERT_COMPLAINT(read(many), "line 4103", "largest grid");
}

CHECK_TEST(test_grid)
{
  ASSERT_TEXT(write_grid({ 3, 4 }, 5), "grid=3x4 rate=5");
  ASSERT_TEXT(write_grid({ 1, 64 }, 0), "grid=1x64");
  GridHeader header = *read_grid(" by=hand grid=3x4 rate=12.5 ", 1);
  fail_unless(header.grid == Grid({ 3, 4 }) && header.rate == 12.5);
  header = *read_grid("", 1);
  fail_unless(!header.grid && header.rate == 0);
  for (const char *words : { "grid=3", "grid=0x3", "grid=3x65", "grid=3x3x3", "grid=x", "rate=-1",
                             "rate=nan", "rate=5Hz", "rate=" })
    ASSERT_COMPLAINT(read_grid(words, 2), "line 2", "expected");
}

namespace {

std::vector<Cue>
take_all(CueBuilder &builder)
{
  std::vector<Cue> cues;
  while (std::optional<Cue> cue = builder.take())
    cues.push_back(*cue);
  return cues;
}

} // namespace

CHECK_TEST(test_cues_of_frames)
{
  const TactileMap a = make_map(1, 1, { 0.5F });
  const TactileMap b = make_map(1, 1, { 1 });
  CueBuilder builder;
  // 25 frames a second, with times rounded down to milliseconds. A change at 3 s, a gap of one
  // frame at 4 s.
  for (int i = 0; i < 125; i++)
    if (i != 100)
      builder.add(40ms * i, 40ms * i + 39ms, i < 75 ? a : b);
  builder.flush();
  const std::vector<Cue> expected
      = { { 0s, 1s, a }, { 1s, 2s, a }, { 2s, 3s, a }, { 3s, 3999ms, b }, { 4040ms, 4999ms, b } };
  fail_unless(take_all(builder) == expected);
}

CHECK_TEST(test_cues_that_overlap)
{
  const TactileMap a = make_map(1, 1, { 0.5F });
  const TactileMap b = make_map(1, 1, { 1 });
  CueBuilder builder;
  builder.add(0s, 800ms, a);
  builder.add(500ms, 900ms, b);
  builder.add(200ms, 300ms, a); // back in time
  builder.flush();
  const std::vector<Cue> expected = { { 0s, 500ms, a }, { 200ms, 300ms, a } };
  const std::vector<Cue> cues = take_all(builder);
  fail_unless(cues == expected);
  builder.add(0s, 800ms, a);
  builder.reset();
  builder.flush();
  fail_unless(take_all(builder).empty());
}

CHECK_MAIN(text_cue)
