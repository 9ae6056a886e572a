// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Fuzzes playlists of HTTP Live Streaming, which another program writes: a media playlist that is
// read has bounded values, and its rendition is written and read as it is; a multivariant one gets
// a track once. Other input is refused with a reason.
#include "tools/tactile-track/hls_playlist.h"
#include "fuzz.h"

#include <chrono>
#include <string_view>

using namespace std::chrono_literals;

static void
check_multivariant(std::string_view text)
{
  const auto variant = hls::first_variant(text);
  if (!variant) {
    expect(!variant.error().empty());
    return;
  }
  if (const auto path = hls::path_of(*variant); path)
    expect(!path->empty() && path->find('\0') == std::string::npos);
  const auto once = hls::with_track(text, "tactile/index.m3u8", "a/tactile.ahap", true);
  expect(once.has_value() && hls::first_variant(*once) == *variant);
  expect(hls::with_track(*once, "tactile/index.m3u8", "a/tactile.ahap", false) == *once);
}

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  const std::string_view text(reinterpret_cast<const char *>(data), size);
  check_multivariant(text);
  const auto segments = hls::read_segments(text);
  if (!segments) {
    expect(!segments.error().empty());
    return 0;
  }
  expect(segments->sequence >= 0 && segments->dates.size() == segments->durations.size());
  for (const hls::Time duration : segments->durations)
    expect(duration >= 0s && duration <= 1h);
  const hls::Rendition rendition{ .segments = *segments, .start = 126'000, .first = 7s };
  const auto again = hls::read_rendition(hls::write_rendition(rendition));
  expect(again && again->start == rendition.start && again->first == rendition.first);
  expect(again->segments.durations.size() == segments->durations.size()
         && again->segments.dates == segments->dates && again->segments.type == segments->type
         && again->segments.is_ended == segments->is_ended);
  if (const auto later = hls::followed(*again, *segments); later)
    expect(later->first == rendition.first && later->start == rendition.start);
  if (const auto read = hls::read_rendition(text); read)
    expect(read->first >= 0s);
  return 0;
}
