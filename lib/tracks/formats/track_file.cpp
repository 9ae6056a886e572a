// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/track_file.h"

#include "tracks/formats/csv.h"
#include "tracks/formats/funscript.h"
#include "tracks/formats/hjif.h"
#include "tracks/formats/mpegv_sem.h"
#include "tracks/formats/webvtt.h"

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <system_error>
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

struct Close
{
  void operator()(std::FILE *file) const
  {
    std::fclose(file);
  }
};

tl::unexpected<FormatError>
wrong(std::string reason)
{
  return tl::unexpected(FormatError{ .place = {}, .reason = std::move(reason) });
}

tl::unexpected<FormatError>
too_large()
{
  return wrong("larger than the " + std::to_string(kMaxTrackFile >> 20) + " MiB that are read");
}

tl::expected<std::string, FormatError>
read_bytes(const std::string &path)
{
  const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "rbe"));
  if (!file)
    return wrong(std::generic_category().message(errno));
  std::error_code no_size; // the size of a pipe is unknown
  const std::uintmax_t size = std::filesystem::file_size(path, no_size);
  std::string text;
  if (!no_size) {
    if (size > kMaxTrackFile)
      return too_large();
    text.reserve(size);
  }
  std::array<char, 65536> piece;
  while (const std::size_t count = std::fread(piece.data(), 1, piece.size(), file.get())) {
    if (text.size() + count > kMaxTrackFile)
      return too_large();
    text.append(piece.data(), count);
  }
  if (std::ferror(file.get()))
    return wrong(std::generic_category().message(errno));
  return text;
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
read_track_bytes(const std::string &path)
{
  return read_bytes(path).map_error(
      [&](FormatError error) { return std::move(error).within("'" + path + "'"); });
}

tl::expected<Track, FormatError>
read_track_file(const std::string &path)
{
  const tl::expected<TrackFormat, FormatError> format = track_format(path);
  if (!format)
    return tl::unexpected(format.error());
  return read_bytes(path)
      .and_then([&](const std::string &bytes) { return read_track(bytes, *format); })
      .map_error([&](FormatError error) { return std::move(error).within("'" + path + "'"); });
}

} // namespace tactile
