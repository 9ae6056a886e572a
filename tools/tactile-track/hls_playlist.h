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

/// The file of a relative URI, without query. Fails for an address.
Read<std::string> path_of(const std::string &uri);

/// Fails for text that an attribute in quotation marks, or an address, cannot have.
Read<std::string> checked_address(const std::string &text);

/// The playlist with subtitles "Tactile" at `uri` in each variant, and with the address of an AHAP
/// file in its session data; empty: none. Those of an earlier call are replaced: subtitles at that
/// URI, a file of that name. Fails for another AHAP file, unless `force` replaces it.
Read<std::string> with_track(std::string_view playlist, const std::string &uri,
                             const std::string &ahap_address, bool force);

/// Segments of a media playlist.
struct Segments
{
  std::int64_t sequence = 0; ///< number of the first one
  std::vector<Time> durations;
  std::vector<std::string> dates{}; ///< lines EXT-X-PROGRAM-DATE-TIME of the segments, or empty
  std::int64_t target = -1;         ///< s, EXT-X-TARGETDURATION, which never changes
  std::string type{};               ///< VOD, EVENT or none
  bool is_ended = false;            ///< it is on demand, or a live stream that is over
};

/// A segment at the end counts when its line of the URI is complete: the file may be half written.
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

/// A rendition of a stream from its 0:00 on. Fails for a live stream whose first segments are gone.
Read<Rendition> begun(Segments now);

/// Number of the oldest segment to keep: players load segments for a while after they left the
/// playlist, its length and theirs (RFC 8216 6.2.2).
std::int64_t oldest_kept(const Segments &segments);

/// The playlist of a rendition; the segment with number n is "n.vtt".
std::string write_rendition(const Rendition &rendition);
/// Fails if it is none of write_rendition().
Read<Rendition> read_rendition(std::string_view playlist);

/// Sets the film time of the first of `now` by what `before` had. Fails if segments in between were
/// missed.
Read<Rendition> followed(const Rendition &before, Segments now);

} // namespace hls
