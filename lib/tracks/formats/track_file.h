// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <cstddef>
#include <string>
#include <string_view>

namespace tactile {

/// The forms in which a track lies in a file; which, its name says.
enum class TrackFormat
{
  webvtt,    ///< .vtt
  csv,       ///< .csv
  hjif,      ///< .hjif
  sem,       ///< .sem.xml
  funscript, ///< .funscript, written alone
};

/// Larger files are not read.
inline constexpr std::size_t kMaxTrackFile = std::size_t{ 256 } << 20;

/// Of a file name; the error says which names there are.
tl::expected<TrackFormat, FormatError> track_format(std::string_view name);

/// The bytes of a file in that form, and back; `date` (ISO 8601) is for HJIF.
std::string write_track(const Track &track, TrackFormat format, const std::string &date);
tl::expected<Track, FormatError> read_track(std::string_view text, TrackFormat format);

/// Reads the file. The place of an error begins with the file's name.
tl::expected<Track, FormatError> read_track_file(const std::string &path);

} // namespace tactile
