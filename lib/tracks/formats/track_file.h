// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

namespace tactile {

/// File formats of a track, chosen by the name's extension.
enum class TrackFormat
{
  webvtt,    ///< .vtt
  csv,       ///< .csv
  hjif,      ///< .hjif
  sem,       ///< .sem.xml
  funscript, ///< .funscript, write-only
};

/// Size limit in bytes; larger files are not read.
inline constexpr std::size_t kMaxTrackFile = std::size_t{ 256 } << 20;

/// What a film's track ends with where the film's name has its ending. Of several the first is
/// taken, also by subtitles' names.
inline constexpr std::array kFilmTrackEndings
    = { ".tactile.vtt", ".vtt", ".csv", ".hjif", ".sem.xml" };

/// Format for a file name; the error lists the known extensions.
tl::expected<TrackFormat, FormatError> track_format(std::string_view name);

/// Converts a track to the content of a file, and back. `date` (ISO 8601) is used for HJIF.
std::string write_track(const Track &track, TrackFormat format, const std::string &date);
tl::expected<Track, FormatError> read_track(std::string_view text, TrackFormat format);

/// The text of a track's file, in UTF-8 where it is UTF-16 (but for XML, which says what it is).
/// Errors start with its name, as those of read_track_file().
tl::expected<std::string, FormatError> read_track_text(const std::string &path);

/// Reads a file.
tl::expected<Track, FormatError> read_track_file(const std::string &path);

} // namespace tactile
