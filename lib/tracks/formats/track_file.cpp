// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/track_file.h"

#include "files/regular_file.h"
#include "tracks/formats/ahap.h"
#include "tracks/formats/csv.h"
#include "tracks/formats/funscript.h"
#include "tracks/formats/haptic.h"
#include "tracks/formats/hasp.h"
#include "tracks/formats/hjif.h"
#include "tracks/formats/json_document.h"
#include "tracks/formats/mpegv_sem.h"
#include "tracks/formats/tact.h"
#include "tracks/formats/utf16.h"
#include "tracks/formats/webvtt.h"

#include <array>
#include <optional>
#include <utility>

namespace tactile {

namespace {

struct Format
{
  std::string_view ending;
  TrackFormat format;
  bool is_written = true;
};

constexpr std::array kFormats = {
  Format{ ".vtt", TrackFormat::webvtt },          Format{ ".csv", TrackFormat::csv },
  Format{ ".hjif", TrackFormat::hjif },           Format{ ".sem.xml", TrackFormat::sem },
  Format{ ".haptic", TrackFormat::haptic },       Format{ ".ahap", TrackFormat::ahap },
  Format{ ".funscript", TrackFormat::funscript }, Format{ ".tact", TrackFormat::tact, false },
  Format{ ".hasp", TrackFormat::hasp, false },
};

/// ".vtt, .csv or .hjif"
std::string
endings(bool is_written)
{
  std::vector<std::string_view> names;
  for (const Format &each : kFormats)
    if (!is_written || each.is_written)
      names.push_back(each.ending);
  std::string text;
  for (std::size_t i = 0; i < names.size(); i++)
    text += (i == 0 ? "" : i + 1 < names.size() ? ", " : " or ") + std::string(names[i]);
  return text;
}

tl::expected<TrackFormat, FormatError>
format_for(std::string_view name, bool is_written)
{
  for (const Format &each : kFormats)
    if (name.ends_with(each.ending) && (each.is_written || !is_written))
      return each.format;
  return tl::unexpected(
      FormatError{ .place = "'" + std::string(name) + "'",
                   .reason = "expected a name that ends in " + endings(is_written) });
}

/// Format of a text by what only that format has.
std::optional<TrackFormat>
format_of(std::string_view text)
{
  if (text.starts_with("\xEF\xBB\xBF"))
    text.remove_prefix(3);
  if (text.starts_with("WEBVTT"))
    return TrackFormat::webvtt;
  if (text.starts_with("# tactile"))
    return TrackFormat::csv;
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first != std::string_view::npos && text[first] == '<')
    return TrackFormat::sem;
  if (first == std::string_view::npos || text[first] != '{')
    return std::nullopt;
  const auto document = JsonDocument::parse(text);
  if (!document)
    return std::nullopt;
  FirstError error;
  const JsonMembers root = document->root(error);
  return root.has("perceptions") ? TrackFormat::hjif
         : root.has("signals")   ? TrackFormat::haptic
         : root.has("clips")     ? TrackFormat::hasp
         : root.has("Pattern")   ? TrackFormat::ahap
         : root.has("project")   ? TrackFormat::tact
         : root.has("actions") || root.has("axes") || root.has("channels")
                 || root.has_object("tracks")
             ? std::optional(TrackFormat::funscript)
             : std::nullopt;
}

} // namespace

tl::expected<TrackFormat, FormatError>
track_format(std::string_view name)
{
  return format_for(name, false);
}

tl::expected<TrackFormat, FormatError>
written_format(std::string_view name)
{
  return format_for(name, true);
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
  case TrackFormat::haptic:
    return write_haptic(track);
  case TrackFormat::ahap:
    return write_ahap(track);
  case TrackFormat::funscript:
    return write_funscript(track);
  case TrackFormat::tact:
  case TrackFormat::hasp:
    break;
  }
  return {};
}

tl::expected<Track, FormatError>
read_track(std::string_view text, TrackFormat format, std::vector<std::string> *ignored,
           const std::string &clip)
{
  std::vector<std::string> none;
  std::vector<std::string> &parts = ignored ? *ignored : none;
  switch (format) {
  case TrackFormat::webvtt:
    return read_webvtt(text);
  case TrackFormat::csv:
    return read_csv(text);
  case TrackFormat::hjif:
    return read_hjif(text, parts);
  case TrackFormat::sem:
    return read_sem(text);
  case TrackFormat::haptic:
    return read_haptic(text);
  case TrackFormat::ahap:
    return read_ahap(text, parts);
  case TrackFormat::funscript:
    return read_funscript(text, parts);
  case TrackFormat::hasp:
    return read_hasp(text, clip, parts);
  case TrackFormat::tact:
    return read_tact(text, parts);
  }
  return Track();
}

tl::expected<TrackText, FormatError>
track_text(std::string bytes, const std::string &name)
{
  const auto named = track_format(name);
  if (named == TrackFormat::sem)
    return TrackText{ .text = std::move(bytes), .format = TrackFormat::sem };
  std::string text = as_utf8(std::move(bytes));
  const auto format = named ? std::optional(*named) : format_of(text);
  if (!format)
    return tl::unexpected(
        FormatError{ .place = named.error().place,
                     .reason = named.error().reason + ", or the text of such a file" });
  return TrackText{ .text = std::move(text), .format = *format };
}

tl::expected<TrackText, FormatError>
read_track_text(const std::string &path)
{
  auto bytes = files::read(path, kMaxTrackFile);
  if (!bytes)
    return tl::unexpected(FormatError{ "'" + path + "'", bytes.error().reason });
  return track_text(*std::move(bytes), path);
}

tl::expected<Track, FormatError>
read_track_file(const std::string &path)
{
  return read_track_text(path).and_then([&](const TrackText &file) {
    return read_track(file.text, file.format).map_error([&](FormatError error) {
      return std::move(error).within("'" + path + "'");
    });
  });
}

} // namespace tactile
