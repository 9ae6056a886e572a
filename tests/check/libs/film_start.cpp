// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Where a film's 0:00 is, by the segments and first time stamps that GStreamer 1.22's demuxers
// give. tests/tools/film_times.py holds it against players.
#include "gst/cues/film_start.h"

#include "support/check_tests.h"

using visuotactile::Time;

namespace {

constexpr GstClockTime kMs = GST_MSECOND;

/// Times in ms.
GstSegment
segment(guint64 start, guint64 time, guint64 base = 0)
{
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.start = segment.position = start * kMs;
  segment.time = time * kMs;
  segment.base = base * kMs;
  return segment;
}

void
expect(const FilmStart &start, Time::rep stream, Time::rep running)
{
  fail_unless_equals_int64(start.stream_time().count(), stream * static_cast<Time::rep>(kMs));
  fail_unless_equals_int64(start.running_time().count(), running * static_cast<Time::rep>(kMs));
}

} // namespace

/// A transport stream, whose clock begins 740 ms before the picture: the sound is the earliest,
/// which the demuxer does not know yet when it begins.
CHECK_TEST(test_clock)
{
  FilmStart start;
  expect(start, 0, 0);
  start.add_segment(segment(740, 740));
  expect(start, 740, 0);
  start.add_first(segment(740, 740), 740 * kMs);
  start.add_first(segment(740, 740), 717 * kMs);
  start.add_first(segment(740, 740), 1500 * kMs); // a second sound
  expect(start, 717, -23);
}

/// A program stream after 100 s, whose clock began .54 s before the picture.
CHECK_TEST(test_late_clock)
{
  FilmStart start;
  start.add_segment(segment(100540, 540));
  start.add_first(segment(100540, 540), 100540 * kMs);
  start.add_first(segment(100540, 540), 100529 * kMs);
  expect(start, 529, -11);
}

/// A Matroska file that begins at ten hours, and an MP4 with an edit of B-frames: GStreamer takes
/// that away itself.
CHECK_TEST(test_time_lines)
{
  FilmStart matroska;
  matroska.add_segment(segment(36'000'000, 0));
  matroska.add_first(segment(36'000'000, 0), 36'000'000 * kMs);
  expect(matroska, 0, 0);
  FilmStart edited;
  edited.add_segment(segment(40, 0));
  edited.add_first(segment(40, 0), 40 * kMs);
  expect(edited, 0, 0);
}

/// An MP4 with an empty edit of 2 s, which players show.
CHECK_TEST(test_empty_edit)
{
  FilmStart start;
  start.add_segment(segment(0, 0));
  start.add_segment(segment(40, 2000, 2000));
  start.add_first(segment(40, 2000, 2000), 40 * kMs);
  expect(start, 0, 0);
}

/// Segments after a seek count no more, nor do those that are not of time.
CHECK_TEST(test_later)
{
  FilmStart start;
  GstSegment bytes;
  gst_segment_init(&bytes, GST_FORMAT_BYTES);
  start.add_segment(bytes);
  start.add_first(bytes, 5);
  start.add_first(segment(0, 0), GST_CLOCK_TIME_NONE);
  start.add_segment(segment(740, 740));
  start.add_segment(segment(5000, 5000));
  expect(start, 740, 0);
}

CHECK_MAIN(film_start)
