// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What a draft was made with, in its file.
#include "tracks/formats/draft_note.h"
#include "tracks/formats/track_file.h"

#include <string>

#include "support/check_tests.h"

using namespace std::chrono_literals;

namespace {

constexpr const char *kMadeWith = "grid=2x2 rate=5 profile=tuned sound=off version=1.2-3";

constexpr tactile::TrackFormat kTelling[]
    = { tactile::TrackFormat::webvtt, tactile::TrackFormat::csv, tactile::TrackFormat::hjif,
        tactile::TrackFormat::sem };

tactile::Track
track()
{
  tactile::Track track(2, 2);
  track.set_rate(5);
  tactile::TactileMap map(2, 2);
  map.levels = { 0, 0.5, 1, 0.25 };
  fail_unless(track.append(1s, map).has_value());
  fail_unless(track.set_end(2s).has_value());
  return track;
}

std::string
text_of(tactile::TrackFormat format)
{
  return tactile::write_track(track(), format, "2026-01-01");
}

} // namespace

/// The note is read again, and the track is as it was.
CHECK_TEST(test_formats)
{
  for (const tactile::TrackFormat format : kTelling) {
    const std::string text = tactile::with_draft_note(text_of(format), kMadeWith);
    const auto note = tactile::draft_note(text);
    fail_unless(note && note->is_unchanged);
    fail_unless_equals_string(note->made_with.c_str(), kMadeWith);
    const auto read = tactile::read_track(text, format);
    fail_unless(read && *read == track(), "%s", read ? "" : read.error().text().c_str());
  }
}

/// A byte before or after the note, or in it, changes the sum.
CHECK_TEST(test_changes)
{
  for (const tactile::TrackFormat format : kTelling) {
    const std::string text = tactile::with_draft_note(text_of(format), kMadeWith);
    const std::size_t note = text.find("grid=");
    for (const std::size_t at : { note - 1, note + 5, text.size() - 2 }) {
      std::string changed = text;
      changed[at] = changed[at] == '8' ? '7' : '8';
      const auto found = tactile::draft_note(changed);
      fail_unless(!found || !found->is_unchanged, "byte %zu", at);
    }
    fail_if(tactile::draft_note(text + " ")->is_unchanged);
  }
}

/// A note in place of an older one.
CHECK_TEST(test_again)
{
  const std::string text = text_of(tactile::TrackFormat::webvtt);
  const std::string once = tactile::with_draft_note(text, kMadeWith);
  fail_unless(
      tactile::with_draft_note(tactile::with_draft_note(text, "grid=2x2 other=1"), kMadeWith)
      == once);
}

/// Tracks of before there were notes tell grid and rate; what is no track tells nothing.
CHECK_TEST(test_others)
{
  const auto older = tactile::draft_note(text_of(tactile::TrackFormat::webvtt));
  fail_unless(older && !older->is_unchanged);
  fail_unless_equals_string(older->made_with.c_str(), "grid=2x2 rate=5");
  fail_if(tactile::draft_note(""));
  fail_if(tactile::draft_note("WEBVTT\n\n00:01.000 --> 00:02.000\n1 2\n3 4\n"));
  fail_if(tactile::draft_note(std::string(1 << 20, ' ') + "grid=1x1"));
  const std::string plain = text_of(tactile::TrackFormat::funscript);
  fail_unless(tactile::with_draft_note(plain, kMadeWith) == plain);
  fail_unless(tactile::draft_note("grid=")->made_with == "grid=");
  fail_if(tactile::draft_note("grid=1x1 sum=")->is_unchanged);
}

CHECK_MAIN(draft_note)
