// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactile-track/hls_playlist.h"
#include "tactile-track/hls_segment.h"

#include "tracks/formats/csv.h"

#include <string>

#include "support/check_tests.h"

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
  std::string text
      = "#EXTM3U\n#EXT-X-TARGETDURATION:3\n#EXT-X-MEDIA-SEQUENCE:" + std::to_string(first) + "\n";
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

CHECK_TEST(test_multivariant)
{
  fail_unless(*hls::first_variant(kMaster) == "low/low.m3u8");
  fail_if(hls::first_variant(media(0, 1)).has_value());
  const std::string once = *hls::with_track(kMaster, "tactile/index.m3u8", "tactile.ahap", false);
  // In the group that a variant has, and in one of its own for the other; what was there stays.
  for (const char *line :
       { "GROUP-ID=\"subs\",NAME=\"Tactile\"", "GROUP-ID=\"tactile\",NAME=\"Tactile\"",
         "BANDWIDTH=1,SUBTITLES=\"subs\"\nlow/low.m3u8",
         "BANDWIDTH=2,SUBTITLES=\"tactile\"\nhigh.m3u8", "NAME=\"English\",URI=\"en.m3u8\"",
         "VALUE=\"tactile.ahap\"" })
    fail_unless(count_of(once, line) == 1, "%s: %s", line, once.c_str());
  const std::string twice = *hls::with_track(once, "tactile/index.m3u8", "a/tactile.ahap", false);
  fail_unless(count_of(twice, "NAME=\"Tactile\"") == 2 && count_of(twice, "ahap") == 1);
  const auto live = hls::with_track(twice, "tactile/index.m3u8", "", false);
  fail_unless(live && count_of(*live, "ahap") == 0);
}

CHECK_TEST(test_live)
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

CHECK_TEST(test_refused)
{
  for (const char *line :
       { "#EXTINF:2.5x,\na.ts\n", "#EXTINF:1,\n#EXTINF:1,\na.ts\n", "#EXT-X-TARGETDURATION:x\n",
         "#EXT-X-PLAYLIST-TYPE:x\n", "#EXT-X-DISCONTINUITY-SEQUENCE:1\n", "#EXTINF:-1,\n",
         "#EXTINF:4000,\n", "#EXTINF:nan,\n", "#EXTINF:,\n", "#EXT-X-DISCONTINUITY\n",
         "#EXT-X-MEDIA-SEQUENCE:-1\n", "#EXT-X-MEDIA-SEQUENCE:99999999999999999999\n" })
    fail_if(hls::read_segments(media(0, 0) + line).has_value(), "%s", line);
  fail_if(hls::read_segments("").has_value());
  for (const char *state : { "", "#tactile-track \n", "#tactile-track 1\n", "#tactile-track 1 -1\n",
                             "#tactile-track x 1\n" })
    fail_if(hls::read_rendition(media(0, 0) + state).has_value(), "%s", state);
}

// Haptics that others put there are kept, or replaced by --force.
CHECK_TEST(test_haptics_of_others)
{
  const std::string line
      = "#EXT-X-SESSION-DATA:DATA-ID=\"com.apple.hls.haptics.url\",VALUE=\"x/own.ahap\"";
  const auto with = [](const std::string &playlist, bool force) {
    return hls::with_track(playlist, "tactile/index.m3u8", "tactile.ahap", force);
  };
  fail_if(with(kMaster + line + "\n", false).has_value());
  const auto forced = with(kMaster + line + "\n", true);
  fail_unless(forced && count_of(*forced, "own.ahap") == 0);
  const auto of_a_language = with(kMaster + line + ",LANGUAGE=\"de\"\n", false);
  fail_unless(of_a_language && count_of(*of_a_language, "own.ahap") == 1);
}

CHECK_TEST(test_addresses)
{
  fail_unless(*hls::path_of("-a/low.m3u8?token=1#x") == "-a/low.m3u8");
  fail_unless(*hls::path_of("film%201.m3u8") == "film 1.m3u8");
  for (const char *uri : { "https://example.org/a.m3u8", "?a", "a%00.m3u8", "a%.m3u8" })
    fail_if(hls::path_of(uri).has_value(), "%s", uri);
  fail_unless(hls::checked_address("https://example.org/caf\xc3\xa9").has_value());
  for (const char *address : { "a\"b", "a\nb", "a b", "a\x7f" })
    fail_if(hls::checked_address(address).has_value(), "%s", address);
}

// Tags that all renditions of a film have alike. RFC 8216 4.3.3.1: 2.5 s are at most 3 s.
CHECK_TEST(test_tags)
{
  const std::string text
      = "#EXTM3U\n#EXT-X-TARGETDURATION:7\n#EXT-X-PLAYLIST-TYPE:EVENT\n"
        "#EXT-X-DISCONTINUITY-SEQUENCE:0\n#EXT-X-MEDIA-SEQUENCE:1\n"
        "#EXT-X-PROGRAM-DATE-TIME:2026-11-27T08:00:00Z\n#EXTINF:2.5,\na.ts\n#EXTINF:2,\nb.ts\n";
  const auto begun = hls::begun(*hls::read_segments(text));
  fail_unless(begun.has_value()); // an EVENT keeps all segments
  const std::string written = hls::write_rendition(*begun);
  for (const char *line :
       { "#EXT-X-TARGETDURATION:7\n", "#EXT-X-PLAYLIST-TYPE:EVENT\n",
         "#EXT-X-PROGRAM-DATE-TIME:2026-11-27T08:00:00Z\n#EXTINF:2.500000,\n1.vtt\n#EXTINF" })
    fail_unless(count_of(written, line) == 1, "%s: %s", line, written.c_str());
}

CHECK_TEST(test_begun)
{
  fail_unless(hls::begun(*hls::read_segments(media(0, 4))).has_value());
  fail_unless(
      hls::begun(*hls::read_segments(media(1, 4, "#EXT-X-PLAYLIST-TYPE:VOD\n"))).has_value());
  fail_if(hls::begun(*hls::read_segments(media(1, 4))).has_value());
  fail_if(hls::begun(*hls::read_segments(media(1, 4, "#EXT-X-ENDLIST\n"))).has_value());
  // Segment 9 left when 10 became the first. It stays for its length and that of the playlist.
  fail_unless(hls::oldest_kept(*hls::read_segments(media(14, 4))) == 9);
}

// However much of a playlist an encoder has written, no segment differs from what it becomes.
CHECK_TEST(test_half_written)
{
  const std::string text = media(12, 3, "#EXT-X-ENDLIST\n");
  const hls::Segments whole = *hls::read_segments(text);
  fail_unless(whole.durations.size() == 3 && whole.is_ended);
  for (std::size_t size = 0; size < text.size(); size++) {
    const auto part = hls::read_segments(text.substr(0, size));
    if (!part)
      continue;
    fail_unless(part->target == 3 && part->durations.size() <= 3);
    fail_unless(part->durations.empty() || part->sequence == 12);
    for (const tactile::Time duration : part->durations)
      fail_unless(duration == 2500ms, "%zu", size);
    fail_unless(part->durations.size() == count_of(text.substr(0, size), "a.ts\n"), "%zu", size);
  }
}

// A cue across the end of a segment is in both, each with its part.
CHECK_TEST(test_segment)
{
  const tactile::Track track = *tactile::read_csv("# tactile grid=1x1 rate=0\ntime_ms,t0\n0,0\n"
                                                  "1900,0.5\n2100,0\n3000,0.25\n4500,0\n");
  const auto cues = tactile::cues_of(track);
  const std::string first = hls::segment_text(cues, track, 126'000, 0s, 2s);
  fail_unless(first.starts_with("WEBVTT\nX-TIMESTAMP-MAP=MPEGTS:126000,LOCAL:00:00:00.000\n\n"));
  fail_unless(count_of(first, "00:00:01.900 --> 00:00:02.000") == 1, "%s", first.c_str());
  const std::string second = hls::segment_text(cues, track, 126'000, 2s, 4s);
  fail_unless(count_of(second, "00:00:02.000 --> 00:00:02.100") == 1
                  && count_of(second, "00:00:03.000 --> 00:00:04.000") == 1,
              "%s", second.c_str());
}

CHECK_MAIN(hls_playlist)
