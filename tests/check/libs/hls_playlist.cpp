// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactile-track/hls_playlist.h"

#include <string>

#include <gst/check/gstcheck.h>

using namespace std::chrono_literals;

namespace {

const std::string kMaster
    = "#EXTM3U\r\n#EXT-X-VERSION:6\r\n"
      "#EXT-X-MEDIA:TYPE=SUBTITLES,GROUP-ID=\"subs\",NAME=\"English\",URI=\"en.m3u8\"\r\n"
      "#EXT-X-STREAM-INF:BANDWIDTH=1,SUBTITLES=\"subs\"\r\nlow/low.m3u8\r\n"
      "#EXT-X-STREAM-INF:BANDWIDTH=2\r\nhigh.m3u8\r\n";

std::string
media(int first, int count, const char *end = "")
{
  std::string text = "#EXTM3U\n#EXT-X-MEDIA-SEQUENCE:" + std::to_string(first) + "\n";
  for (int i = 0; i < count; i++)
    text += "#EXTINF:2.5,\na.ts\n";
  return text + end;
}

std::size_t
count_of(const std::string &text, const std::string &part)
{
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    count++;
  return count;
}

} // namespace

GST_START_TEST(test_multivariant)
{
  fail_unless(*hls::first_variant(kMaster) == "low/low.m3u8");
  fail_if(hls::first_variant(media(0, 1)).has_value());
  const std::string once = hls::with_track(kMaster, "tactile/index.m3u8", "tactile.ahap");
  // In the group that a variant has, and in one of its own for the other; what was there stays.
  for (const char *line :
       { "GROUP-ID=\"subs\",NAME=\"Tactile\"", "GROUP-ID=\"tactile\",NAME=\"Tactile\"",
         "BANDWIDTH=1,SUBTITLES=\"subs\"\nlow/low.m3u8",
         "BANDWIDTH=2,SUBTITLES=\"tactile\"\nhigh.m3u8", "NAME=\"English\",URI=\"en.m3u8\"",
         "VALUE=\"tactile.ahap\"" })
    fail_unless(count_of(once, line) == 1, "%s: %s", line, once.c_str());
  const std::string twice = hls::with_track(once, "tactile/index.m3u8", "other.ahap");
  fail_unless(count_of(twice, "NAME=\"Tactile\"") == 2 && count_of(twice, "ahap") == 1);
}
GST_END_TEST;

GST_START_TEST(test_live)
{
  const hls::Rendition begun{ .segments = *hls::read_segments(media(0, 4)), .start = 126'000 };
  const auto kept = hls::read_rendition(hls::write_rendition(begun));
  fail_unless(kept && kept->start == 126'000 && kept->first == 0s && !kept->segments.is_ended);
  fail_unless(kept->segments.durations == begun.segments.durations);
  const auto later = hls::followed(*kept, *hls::read_segments(media(3, 4, "#EXT-X-ENDLIST\n")));
  fail_unless(later && later->first == 7500ms && later->segments.is_ended);
  const auto again = hls::read_rendition(hls::write_rendition(*later));
  fail_unless(again && again->first == 7500ms && again->segments.sequence == 3);
  fail_unless(hls::followed(*later, *hls::read_segments(media(7, 1)))->first == 17'500ms);
  fail_if(hls::followed(*later, *hls::read_segments(media(8, 1))).has_value());
  fail_if(hls::followed(*later, *hls::read_segments(media(2, 1))).has_value());
}
GST_END_TEST;

GST_START_TEST(test_refused)
{
  for (const char *line : { "#EXTINF:-1,\n", "#EXTINF:4000,\n", "#EXTINF:nan,\n", "#EXTINF:,\n",
                            "#EXT-X-DISCONTINUITY\n", "#EXT-X-MEDIA-SEQUENCE:-1\n",
                            "#EXT-X-MEDIA-SEQUENCE:99999999999999999999\n" })
    fail_if(hls::read_segments(std::string("#EXTM3U\n") + line).has_value(), "%s", line);
  fail_if(hls::read_segments("").has_value());
  for (const char *state : { "", "#tactile-track \n", "#tactile-track 1\n", "#tactile-track 1 -1\n",
                             "#tactile-track x 1\n" })
    fail_if(hls::read_rendition(std::string("#EXTM3U\n") + state).has_value(), "%s", state);
}
GST_END_TEST;

static Suite *
hls_playlist_suite(void)
{
  Suite *suite = suite_create("hls_playlist");
  TCase *tests = tcase_create("general");
  suite_add_tcase(suite, tests);
  tcase_add_test(tests, test_multivariant);
  tcase_add_test(tests, test_live);
  tcase_add_test(tests, test_refused);
  return suite;
}

GST_CHECK_MAIN(hls_playlist)
