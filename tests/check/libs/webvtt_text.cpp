// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A track's file that is edited: what is not changed has the bytes that it had.
#include "tracks/formats/webvtt_text.h"
#include "tracks/formats/utf16.h"
#include "tracks/formats/webvtt.h"
#include "tracks/track_edit.h"

#include <regex>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "track_samples.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactile;

namespace {

const std::string kNotes = "WEBVTT - by Anna\n"
                           "\n"
                           "NOTE tactile grid=3x3 rate=5 by=hand\n"
                           "\n"
                           "NOTE the storm begins here\n"
                           "\n"
                           "STYLE\n"
                           "::cue { color: lime }\n"
                           "\n"
                           "thunder 1\n"
                           "00:00:01.000 --> 00:00:01.400  line:0 \n"
                           "  0   0   0\n"
                           "  0  75  75\n"
                           "  0   0   0\n"
                           "\n\n"
                           "NOTE review: accepted\n"
                           "\n"
                           "REGION\n"
                           "id:a\n"
                           "\n"
                           "00:02.000 -->\t00:02.400\n"
                           "0 0 0 0 0 0\n"
                           "50% 0 0\n"
                           "\n"
                           "00:00:02.100 --> 00:00:03.000\n"
                           "what an impact!\n"
                           "\n"
                           "NOTE the end";

WebvttText
text_of(const std::string &file)
{
  const auto track = read_webvtt(file);
  fail_unless(track.has_value(), "%s", track ? "" : track.error().text().c_str());
  return { file, { track->rows(), track->columns() } };
}

void
assert_text(const std::string &text, const std::string &expected)
{
  fail_unless(text == expected, "expected:\n%s\ngot:\n%s", expected.c_str(), text.c_str());
}

std::string
replaced(const std::string &text, const std::string &what, const std::string &by)
{
  fail_unless(text.find(what) != std::string::npos, "no '%s'", what.c_str());
  std::string result = text;
  return result.replace(text.find(what), what.size(), by);
}

} // namespace

CHECK_TEST(test_unchanged)
{
  const std::string files[] = {
    kNotes,
    std::regex_replace(kNotes, std::regex("\n"), "\r\n"),
    std::regex_replace(kNotes, std::regex("\n"), "\r"),
    "\xef\xbb\xbf" + kNotes + "\n\n",
    // bytes that are no UTF-8
    replaced(kNotes, "Anna", "Andr\xe9"),
  };
  for (const std::string &file : files)
    assert_text(text_of(file).with(*read_webvtt(file), 0s), file);
}

/// Times move, and nothing else changes.
CHECK_TEST(test_shift)
{
  std::string expected
      = replaced(kNotes, "00:00:01.000 --> 00:00:01.400", "00:00:02.500 --> 00:00:02.900");
  expected = replaced(expected, "00:02.000 -->\t00:02.400", "00:00:03.500 --> 00:00:03.900");
  expected = replaced(expected, "00:00:02.100 --> 00:00:03.000", "00:00:03.600 --> 00:00:04.500");
  const Track track = *read_webvtt(kNotes);
  assert_text(text_of(kNotes).with(*shift(track, 1500ms), 1500ms), expected);
  // There and back.
  assert_text(text_of(expected).with(*shift(*shift(track, 1500ms), -1500ms), -1500ms),
              replaced(kNotes, "00:02.000 -->\t00:02.400", "00:00:02.000 --> 00:00:02.400"));
}

/// What is moved to before 0 is gone: cues with their notes. Blocks that are none stay.
CHECK_TEST(test_shift_before_the_beginning)
{
  const std::string moved = text_of(kNotes).with(*shift(*read_webvtt(kNotes), -2200ms), -2200ms);
  fail_unless(read_webvtt(moved) == *shift(*read_webvtt(kNotes), -2200ms), "%s", moved.c_str());
  for (const char *gone : { "thunder", "75" })
    fail_unless(moved.find(gone) == std::string::npos, "%s in %s", gone, moved.c_str());
  for (const char *left :
       { "by Anna", "by=hand", "the storm", "::cue", "NOTE review: accepted\n", "REGION\nid:a\n",
         "00:00:00.000 --> 00:00:00.200\n0 0 0 0 0 0\n50% 0 0\n",
         "00:00:00.000 --> 00:00:00.800\nwhat an impact!\n", "NOTE the end" })
    fail_unless(moved.find(left) != std::string::npos, "no %s in %s", left, moved.c_str());
}

/// Only the pictures of cues that change.
CHECK_TEST(test_levels)
{
  const Track track = *read_webvtt(kNotes);
  assert_text(text_of(kNotes).with(mask(track, { 4 }), 0s),
              replaced(kNotes, "  0  75  75\n", "  0   0  75\n"));
  // A changed cue of another layout is written anew; its notes, identifier and settings stay.
  assert_text(text_of(kNotes).with(scale(track, 0.8F), 0s),
              replaced(replaced(kNotes, "  0  75  75\n", "  0  60  60\n"), "0 0 0 0 0 0\n50% 0 0\n",
                       "  0   0   0\n  0   0   0\n 40   0   0\n"));
}

/// A part of a cue keeps what the cue had. A silent one stays for its note, another goes.
CHECK_TEST(test_parts)
{
  const Track track = *read_webvtt(kNotes);
  assert_text(text_of(kNotes).with(*silence(track, 900ms, 1100ms), 0s),
              replaced(kNotes, "00:00:01.000 -->", "00:00:01.100 -->"));
  assert_text(
      text_of(kNotes).with(*silence(track, 1900ms, 3s), 0s),
      replaced(kNotes, "0 0 0 0 0 0\n50% 0 0\n", "  0   0   0\n  0   0   0\n  0   0   0\n"));
  const std::string without = text_of(kNotes).with(*silence(track, 0s, 1500ms), 0s);
  fail_unless(without.find("thunder") == std::string::npos);
  fail_unless(without.find("NOTE the storm begins here\n\nSTYLE\n::cue { color: lime }\n")
              != std::string::npos);
}

/// The note says the new grid; its other words stay. A remark stays, too.
CHECK_TEST(test_other_grid)
{
  const Track track = *resample(*read_webvtt(kNotes), 2, 1);
  const std::string text = text_of(kNotes).with(track, 0s);
  fail_unless(read_webvtt(text) == at_resolution(track, kTextTick, kTextSteps), "%s", text.c_str());
  for (const char *left :
       { "NOTE tactile grid=2x1 rate=5 by=hand\n", "thunder 1\n", "  line:0 \n",
         "NOTE review: accepted", "::cue", "id:a", "what an impact!", "the end" })
    fail_unless(text.find(left) != std::string::npos, "no %s in %s", left, text.c_str());
}

/// Whatever a track becomes, the file that is written is read as that.
CHECK_TEST(test_any_track)
{
  for (unsigned seed = 0; seed < 100; seed++) {
    const Track track = random_track(seed, kTextTick, kTextSteps);
    std::string file = write_webvtt(track);
    if (const std::size_t cue = file.find("\n00:"); cue != std::string::npos)
      file.insert(cue, "\nNOTE a remark\n\nnamed");
    const WebvttText text(file, { track.rows(), track.columns() });
    assert_text(text.with(track, 0s), file);
    const Track edits[] = { *shift(track, 1234567us),
                            *shift(track, -track.end() / 3),
                            *clip(track, track.end() / 4, track.end() / 2),
                            prune_short(track, 50ms),
                            scale(track, 0.3F),
                            *resample(track, 2, 3),
                            *clip(track, 0s, 0s),
                            *overlay(track, random_track(seed + 1, 10us, 0), Mix::max) };
    const Time offsets[] = { 1234567us, -track.end() / 3, -track.end() / 4 };
    for (std::size_t i = 0; i < std::size(edits); i++) {
      const std::string edited = text.with(edits[i], i < std::size(offsets) ? offsets[i] : Time(0));
      fail_unless(read_webvtt(edited) == at_resolution(edits[i], kTextTick, kTextSteps),
                  "seed %u, edit %zu: %s", seed, i, edited.c_str());
    }
  }
}

CHECK_TEST(test_utf16)
{
  // A G clef and an umlaut; expected bytes by iconv.
  const std::string utf8 = "W\xc3\xa4\xf0\x9d\x84\x9e\n";
  assert_text(as_utf8(std::string("\xff\xfeW\0\xe4\0\x34\xd8\x1e\xdd\n\0", 12)), utf8);
  assert_text(as_utf8(std::string("\xfe\xff\0W\0\xe4\xd8\x34\xdd\x1e\0\n", 12)), utf8);
  assert_text(as_utf8(std::string("W\0\xe4\0\x34\xd8\x1e\xdd\n\0", 10)), utf8);
  assert_text(as_utf8(std::string("\0W\0\xe4\xd8\x34\xdd\x1e\0\n", 10)), utf8);
  // Half a pair, half a unit.
  assert_text(as_utf8(std::string("\xff\xfe\x34\xd8W\0\x1e\xdd\n", 9)),
              "\xef\xbf\xbdW\xef\xbf\xbd\xef\xbf\xbd");
  for (const std::string stays : { "", "W", "WEBVTT", "\xef\xbb\xbfWEBVTT", "\xff" })
    assert_text(as_utf8(stays), stays);
}

/// A silent cue may have a frequency, which nobody feels.
CHECK_TEST(test_silent_cue_with_a_frequency)
{
  const std::string silent = "WEBVTT\n\n00:00.000 --> 00:01.000\n0\n50 Hz\n";
  const std::string file = silent + "\n00:01.000 --> 00:02.000\n80\n";
  assert_text(text_of(file).with(scale(*read_webvtt(file), 0.5F), 0s),
              silent + "\n00:01.000 --> 00:02.000\n 40\n");
}

CHECK_MAIN(webvtt_text)
