// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Fuzzes tracks in one format per program (TRACK_FORM): a track that parses survives a round trip.
// Other input is refused with a reason.
#include "fuzz.h"
#include "tracks/klv.h"
#include "tracks/text_cue.h"
#include "tracks/track_edit.h"

#ifndef TRACK_FORM_KLV
#include "tracks/formats/track_file.h"
#endif

#include <string_view>

using namespace tactile;

namespace {

#ifdef TRACK_FORM_KLV
void
check(std::string_view bytes)
{
  const auto cue = read_klv({ reinterpret_cast<const std::uint8_t *>(bytes.data()), bytes.size() });
  if (!cue)
    return expect(!cue.error().text().empty());
  expect(*read_klv(write_klv(cue->map, cue->end)) == *cue);
}
#else
void
check(std::string_view bytes)
{
  constexpr auto kForm = TrackFormat::TRACK_FORM;
  const auto read = read_track(bytes, kForm);
  if (!read)
    return expect(!read.error().text().empty());
  const Track &track = *read;
  expect(track.entries().front().time == Time(0));
  for (const Track::Entry &entry : track.entries()) {
    expect(entry.map.rows == track.rows() && entry.map.columns == track.columns());
    const float frequency = entry.map.frequency;
    expect(frequency == 0 || (frequency >= 1 && frequency <= kHighestFrequency));
    for (const float level : entry.map.levels)
      expect(level >= 0 && level <= 1);
  }
  if (write_track(track, kForm, "").empty()) // a format that is only read
    return;
  // WebVTT has a cue per second: writing a hundred hours takes a thousand times as long as reading.
  if (track.end() > std::chrono::minutes(10))
    return;
  // Twice, because the first round trip may round.
  const Track again = *read_track(write_track(track, kForm, "2026-01-01"), kForm);
  const Track once_more = *read_track(write_track(again, kForm, "2026-01-01"), kForm);
  expect(once_more.entries() == again.entries());
  // cppcheck-suppress mismatchingContainerExpression ; a time, no iterator
  expect(once_more.end() == again.end());
  expect(diff(again, once_more)->empty());
}
#endif

} // namespace

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  check({ reinterpret_cast<const char *>(data), size });
  return 0;
}
