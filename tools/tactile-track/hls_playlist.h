// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

/// Playlists of HTTP Live Streaming (RFC 8216).
namespace hls {

using visuotactile::Time;

/// Errors are one line.
template <typename Value> using Read = tl::expected<Value, std::string>;

/// The URI of the first variant of a multivariant playlist.
Read<std::string> first_variant(std::string_view playlist);

/// The playlist with subtitles "Tactile" at `uri` in each variant, and with the address of an AHAP
/// file in its session data. Those of an earlier call are replaced.
std::string with_track(std::string_view playlist, const std::string &uri,
                       const std::string &ahap_address);

/// Segments of a media playlist.
struct Segments
{
  std::int64_t sequence = 0; ///< number of the first one
  std::vector<Time> durations;
  bool is_ended = false; ///< it is on demand, or a live stream that is over
};

/// Fails for more than a million segments, lengths above an hour, and discontinuities, whose time
/// stamps one track cannot follow.
Read<Segments> read_segments(std::string_view playlist);

/// What an earlier call left for the next one of a live stream.
struct Rendition
{
  Segments segments;
  std::int64_t start = 0; ///< time stamp of the film's 0:00 in 90 000 Hz
  Time first{ 0 };        ///< film time at which the first segment begins
};

/// The playlist of a rendition; the segment with number n is "n.vtt".
std::string write_rendition(const Rendition &rendition);
/// Fails if it is none of write_rendition().
Read<Rendition> read_rendition(std::string_view playlist);

/// Sets the film time of the first of `now` by what `before` had. Fails if segments in between were
/// missed.
Read<Rendition> followed(const Rendition &before, Segments now);

} // namespace hls
