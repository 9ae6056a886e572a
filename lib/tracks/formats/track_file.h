// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tactile {

/// File formats of a track, chosen by the name's extension.
enum class TrackFormat
{
  webvtt,    ///< .vtt
  csv,       ///< .csv
  hjif,      ///< .hjif
  sem,       ///< .sem.xml
  haptic,    ///< .haptic
  hasp,      ///< .hasp, read-only: the clip that was open
  ahap,      ///< .ahap
  funscript, ///< .funscript
  tact,      ///< .tact, read-only
};

/// Size limit in bytes; larger files are not read.
inline constexpr std::size_t kMaxTrackFile = std::size_t{ 256 } << 20;

/// Endings that replace that of a film's name in the name of its track. The first existing file is
/// taken, also with the name of subtitles.
inline constexpr std::array kFilmTrackEndings
    = { ".tactile.vtt", ".vtt",  ".csv",       ".hjif", ".sem.xml",
        ".haptic",      ".ahap", ".funscript", ".tact" };

/// Format for the name of a file; the error lists the known extensions.
tl::expected<TrackFormat, FormatError> track_format(std::string_view name);

/// Format for the name of a file to write; the error lists the extensions of formats that are
/// written.
tl::expected<TrackFormat, FormatError> written_format(std::string_view name);

/// Converts a track to the content of a file. `date` (ISO 8601) is used for HJIF. A format that is
/// only read gives an empty text.
std::string write_track(const Track &track, TrackFormat format, const std::string &date);

/// Converts the content of a file to a track. `ignored`, if any, gets the parts that a track cannot
/// represent, as nouns such as "the frequencies". `clip` names a clip of a .hasp project; if it is
/// empty, the clip that was open is read.
tl::expected<Track, FormatError> read_track(std::string_view text, TrackFormat format,
                                            std::vector<std::string> *ignored = nullptr,
                                            const std::string &clip = {});

/// The text of a track's file, converted from UTF-16 to UTF-8 (except XML, which declares its
/// encoding).
struct TrackText
{
  std::string text;
  TrackFormat format; ///< by the file's name, or by its text if the name has no known extension
};

/// Converts the bytes of a file of this name.
tl::expected<TrackText, FormatError> track_text(std::string bytes, const std::string &name);

/// Errors start with the file's name, as those of read_track_file().
tl::expected<TrackText, FormatError> read_track_text(const std::string &path);

/// Reads a file.
tl::expected<Track, FormatError> read_track_file(const std::string &path);

} // namespace tactile
