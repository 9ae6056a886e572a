// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/track_file.h"

#include "files/regular_file.h"
#include "tracks/formats/csv.h"
#include "tracks/formats/funscript.h"
#include "tracks/formats/hjif.h"
#include "tracks/formats/mpegv_sem.h"
#include "tracks/formats/utf16.h"
#include "tracks/formats/webvtt.h"

#include <array>
#include <utility>

namespace tactile {

namespace {

constexpr std::array<std::pair<std::string_view, TrackFormat>, 5> kEndings = { {
    { ".vtt", TrackFormat::webvtt },
    { ".csv", TrackFormat::csv },
    { ".hjif", TrackFormat::hjif },
    { ".sem.xml", TrackFormat::sem },
    { ".funscript", TrackFormat::funscript },
} };

tl::unexpected<FormatError>
wrong(std::string reason)
{
  return tl::unexpected(FormatError{ .place = {}, .reason = std::move(reason) });
}

} // namespace

tl::expected<TrackFormat, FormatError>
track_format(std::string_view name)
{
  for (const auto &[ending, format] : kEndings)
    if (name.ends_with(ending))
      return format;
  return tl::unexpected(FormatError{
      .place = "'" + std::string(name) + "'",
      .reason = "expected a name that ends in .vtt, .csv, .hjif, .sem.xml or .funscript" });
}

std::string
write_track(const Track &track, TrackFormat format, const std::string &date)
{
  switch (format) {
  case TrackFormat::webvtt:
    return write_webvtt(track);
  case TrackFormat::csv:
    return write_csv(track);
  case TrackFormat::hjif:
    return write_hjif(track, date);
  case TrackFormat::sem:
    return write_sem(track);
  case TrackFormat::funscript:
    return write_funscript(track);
  }
  return {};
}

tl::expected<Track, FormatError>
read_track(std::string_view text, TrackFormat format)
{
  switch (format) {
  case TrackFormat::webvtt:
    return read_webvtt(text);
  case TrackFormat::csv:
    return read_csv(text);
  case TrackFormat::hjif:
    return read_hjif(text);
  case TrackFormat::sem:
    return read_sem(text);
  case TrackFormat::funscript:
    break;
  }
  return wrong("a funscript has one axis: it is written, not read");
}

tl::expected<std::string, FormatError>
read_track_text(const std::string &path)
{
  const tl::expected<TrackFormat, FormatError> format = track_format(path);
  if (!format)
    return tl::unexpected(format.error());
  auto bytes = files::read(path, kMaxTrackFile);
  if (!bytes)
    return tl::unexpected(FormatError{ "'" + path + "'", bytes.error().reason });
  return *format == TrackFormat::sem ? *std::move(bytes) : as_utf8(*std::move(bytes));
}

tl::expected<Track, FormatError>
read_track_file(const std::string &path)
{
  return read_track_text(path).and_then([&](const std::string &text) {
    return read_track(text, *track_format(path)).map_error([&](FormatError error) {
      return std::move(error).within("'" + path + "'");
    });
  });
}

} // namespace tactile
