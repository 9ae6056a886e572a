// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/webvtt.h"

#include "track_samples.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactile;

CHECK_TEST(test_text)
{
  Track track = two_tactors(4s);
  track.set_rate(5);
  ASSERT_TEXT(write_webvtt(track), "WEBVTT\n"
                                   "\n"
                                   "NOTE tactile grid=3x3 rate=5\n"
                                   "\n"
                                   "00:00:00.000 --> 00:00:01.000\n"
                                   "  0   0   0\n"
                                   "  0   0   0\n"
                                   "  0   0   0\n"
                                   "\n"
                                   "00:00:01.000 --> 00:00:01.400\n"
                                   "  0   0   0\n"
                                   "  0  75  75\n"
                                   "  0   0   0\n"
                                   "\n"
                                   "00:00:03.000 --> 00:00:04.000\n"
                                   "  0   0   0\n"
                                   "  0   0   0\n"
                                   "  0   0   0\n");
}

CHECK_TEST(test_round_trip)
{
  for (unsigned seed = 0; seed < 200; seed++) {
    const Track track = random_track(seed, kTextTick, kTextSteps);
    fail_unless(read_webvtt(write_webvtt(track)) == track, "seed %u", seed);
    const Track fine = random_track(seed, 10us, 0);
    fail_unless(read_webvtt(write_webvtt(fine)) == at_resolution(fine, kTextTick, kTextSteps),
                "seed %u", seed);
  }
  const Track empty(4, 6);
  fail_unless(read_webvtt(write_webvtt(empty)) == empty);
}

CHECK_TEST(test_text_from_editors)
{
  const Track expected = two_tactors();
  const char *files[] = {
    // byte order mark, CRLF, no note, an identifier, settings, short times
    "\xef\xbb\xbfWEBVTT - a title\r\n\r\n7\r\n00:01.000 --> 00:01.400 align:start line:0\r\n0 0 "
    "0\r\n0 75 75\r\n0 0 0\r\n",
    // notes, styles and regions, header lines
    "WEBVTT\nKind: metadata\n\nSTYLE\n::cue { color: red }\n\nREGION\nid:x\n\nNOTE by hand\n\nNOTE "
    "tactile grid=3x3\n\n00:00:01.000 --> 00:00:01.400\n0 0 0 0 75 75 0 0 0\n\nNOTE\nthe end\n",
    // CR line ends, adjacent cues
    "WEBVTT\r\r00:01.000 --> 00:01.200\r0 0 0\r0 75 75\r0 0 0\r\r00:01.200 --> 00:01.400\r0 0 0\r0 "
    "75 75\r0 0 0",
  };
  for (const char *file : files)
    fail_unless(read_webvtt(file) == expected, "%s", file);
}

CHECK_TEST(test_deleted_cue_is_silence)
{
  std::string text = write_webvtt(two_tactors());
  const std::size_t cue = text.find("00:00:01.000 --> 00:00:01.400");
  text.resize(cue);
  const Track pruned = *read_webvtt(text);
  fail_unless_equals_int(pruned.entries().size(), 1);
  fail_unless(pruned.end() == 1s);
}

CHECK_TEST(test_refused)
{
  const std::string head = "WEBVTT\n\n";
  const std::string cue = "00:01.000 --> 00:02.000\n0 0\n\n";
  const auto read = [&](const std::string &rest) {
    return read_webvtt(head + rest);
  };
  ASSERT_COMPLAINT(read_webvtt(""), "line 1", "WEBVTT");
  ASSERT_COMPLAINT(read_webvtt("1\n00:00:01,000 --> 00:00:02,000\nHello\n"), "line 1", "WEBVTT");
  ASSERT_COMPLAINT(read_webvtt("WEBVTTX\n"), "line 1", "WEBVTT");
  ASSERT_COMPLAINT(read_webvtt("WEBVTT\n" + cue), "line 2", "empty line");
  ASSERT_COMPLAINT(read(""), "line", "no cue");
  ASSERT_COMPLAINT(read("NOTE tactile grid=99x1\n"), "line 3", "grid=");
  ASSERT_COMPLAINT(read("00:01.000 -> 00:02.000\n0\n"), "line 3", "START --> END");
  ASSERT_COMPLAINT(read("00:01.00 --> 00:02.000\n0\n"), "line 3", "HH:MM:SS.mmm");
  ASSERT_COMPLAINT(read("00:61.000 --> 00:62.000\n0\n"), "line 3", "HH:MM:SS.mmm");
  ASSERT_COMPLAINT(read("101:00:00.000 --> 101:00:01.000\n0\n"), "line 3", "100 hours");
  ASSERT_COMPLAINT(read("99999999999:00:00.000 --> 1:00:01.000\n0\n"), "line 3", "100 hours");
  ASSERT_COMPLAINT(read("00:02.000 --> 00:01.000\n0\n"), "line 3", "ends before it begins");
  ASSERT_COMPLAINT(read(cue + cue), "line 6", "overlaps");
  ASSERT_COMPLAINT(read(cue + "00:02.000 --> 00:03.000\n0 0 0\n"), "line 7", "grid of 1x2");
  ASSERT_COMPLAINT(read(cue + "00:00.500 --> 00:00.700\n0 0\n"), "line 6",
                   "out of order: the one before begins later, at 00:00:01.000");
  ASSERT_COMPLAINT(read(cue + "00:01.500 --> 00:02.700\n0 0\n"), "line 6",
                   "overlaps the one before, which ends at 00:00:02.000");
  ASSERT_COMPLAINT(read(cue + "00:02.000 --> 00:03.000\n0 O\n"), "line 7", "'O'; a remark");
  ASSERT_COMPLAINT(read("00:02.000 --> 00:03.000\nHello\n"), "line 4", "'Hello'");
  ASSERT_COMPLAINT(read("00:01.000 --> 00:02.000\n\n"), "line 4", "nothing");
}

/// A cue of words is not felt, whatever it overlaps. It says nothing about the track's length.
CHECK_TEST(test_remarks)
{
  const std::string head = "WEBVTT\n\nNOTE tactile grid=1x2\n\n";
  const std::string cue = "00:01.000 --> 00:02.000\n0 75\n\n";
  const std::string remark = "00:00.500 --> 00:09.000\nwhat a <i>impact</i>...\n\n";
  for (const std::string &text : { remark + cue, cue + remark, cue + remark + remark })
    fail_unless(read_webvtt(head + text) == *read_webvtt(head + cue), "%s", text.c_str());
}

CHECK_TEST(test_meant_as_track)
{
  const std::string faulty = "\n00:01.000 --> 00:02.000\n0 75\n\n00:01.000 --> 00:02.000\n0 75\n";
  fail_unless(is_meant_as_track("WEBVTT\n" + faulty));
  fail_unless(is_meant_as_track("WEBVTT\n\nNOTE tactile grid=9x\n"));
  fail_unless(is_meant_as_track("WEBVTT\n\nNOTE tactile\n\n00:01.000 --> 00:02.000\nHello!\n"));
  fail_if(is_meant_as_track("WEBVTT\n\n00:01.000 --> 00:02.000\nHello!\n" + faulty));
  fail_if(is_meant_as_track("WEBVTT\n\n00:01.000 --> 00:02.000\n1984: London\n"));
  fail_if(is_meant_as_track("WEBVTT\n\nNOTE tactical errors\n"));
  fail_if(is_meant_as_track(""));
}

CHECK_MAIN(webvtt)
