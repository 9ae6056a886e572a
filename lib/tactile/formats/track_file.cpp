// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactile/formats/track_file.h"

#include "tactile/formats/csv.h"
#include "tactile/formats/funscript.h"
#include "tactile/formats/hjif.h"
#include "tactile/formats/mpegv_sem.h"
#include "tactile/formats/webvtt.h"

#include <array>
#include <cerrno>
#include <cstdio>
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

/// The bytes of a file. Throws FormatError.
std::string
read_bytes(const std::string &path)
{
  const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "rbe"));
  if (!file)
    throw FormatError(std::generic_category().message(errno));
  std::string text;
  std::array<char, 65536> piece;
  while (const std::size_t count = std::fread(piece.data(), 1, piece.size(), file.get())) {
    // Before it grows: beyond the limit, it would double once more.
    if (text.size() + count > kMaxTrackFile)
      throw FormatError("larger than the " + std::to_string(kMaxTrackFile >> 20)
                        + " MiB that are read");
    text.append(piece.data(), count);
  }
  if (std::ferror(file.get()))
    throw FormatError(std::generic_category().message(errno));
  return text;
}

} // namespace

TrackFormat
track_format(std::string_view name)
{
  for (const auto &[ending, format] : kEndings)
    if (name.ends_with(ending))
      return format;
  throw FormatError("'" + std::string(name)
                    + "': expected a name that ends in .vtt, .csv, .hjif, .sem.xml or .funscript");
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
  throw FormatError("unknown format");
}

Track
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
  throw FormatError("a funscript has one axis: it is written, not read");
}

Track
read_track_file(const std::string &path)
{
  const TrackFormat format = track_format(path);
  try {
    return read_track(read_bytes(path), format);
  } catch (const FormatError &error) {
    throw FormatError("'" + path + "': " + error.what());
  }
}

} // namespace tactile
