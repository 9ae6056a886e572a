// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hls_playlist.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include <glib.h>

namespace hls {

namespace {

constexpr std::size_t kMostSegments = 1'000'000;
constexpr double kLongest = 3600; ///< s

constexpr std::string_view kVariant = "#EXT-X-STREAM-INF:";
constexpr std::string_view kHaptics = "com.apple.hls.haptics.url";
constexpr std::string_view kAhapName = "tactile.ahap";
constexpr std::size_t kMostDate = 100;
constexpr std::string_view kState = "#tactile-track ";

tl::unexpected<std::string>
expected(const std::string &what)
{
  return tl::unexpected("expected " + what);
}

std::vector<std::string_view>
lines_of(std::string_view text)
{
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    while (line.ends_with('\r'))
      line.remove_suffix(1);
    lines.push_back(line);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return lines;
}

template <typename Number>
std::optional<Number>
number(std::string_view text, char stop = '\0')
{
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && (end == text.data() + text.size() || *end == stop)
             ? std::optional(value)
             : std::nullopt;
}

/// The value of an attribute such as SUBTITLES="subs", without quotation marks.
std::optional<std::string>
attribute(std::string_view line, const std::string &name)
{
  std::size_t at = line.find(name + "=\"");
  while (at != std::string_view::npos && at > 0 && line[at - 1] != ',' && line[at - 1] != ':')
    at = line.find(name + "=\"", at + 1);
  if (at == std::string_view::npos)
    return std::nullopt;
  line.remove_prefix(at + name.size() + 2);
  return std::string(line.substr(0, line.find('"')));
}

Time
seconds(double value)
{
  return Time(std::llround(value * 1e9));
}

std::string
text_of(Time time)
{
  char text[32];
  std::snprintf(text, sizeof text, "%.6f", std::chrono::duration<double>(time).count());
  return text;
}

} // namespace

Read<std::string>
first_variant(std::string_view playlist)
{
  bool is_next = false;
  for (const std::string_view line : lines_of(playlist)) {
    if (is_next && !line.empty() && !line.starts_with('#'))
      return std::string(line);
    is_next = is_next || line.starts_with(kVariant);
  }
  return expected("a multivariant playlist, which has #EXT-X-STREAM-INF; ffmpeg writes one with "
                  "-master_pl_name");
}

Read<std::string>
path_of(const std::string &uri)
{
  if (uri.find("://") != std::string::npos)
    return expected("variants in files, got '" + uri + "'");
  g_autofree gchar *path
      = g_uri_unescape_string(uri.substr(0, uri.find_first_of("?#")).c_str(), nullptr);
  return path != nullptr && *path != '\0' ? Read<std::string>(path)
                                          : expected("a URI of a file, got '" + uri + "'");
}

Read<std::string>
checked_address(const std::string &text)
{
  const bool is_valid = std::ranges::none_of(
      text, [](char c) { return c == '"' || g_ascii_isspace(c) || g_ascii_iscntrl(c); });
  return is_valid ? Read<std::string>(text)
                  : expected("an address without quotation marks and spaces (%22, %20), got '"
                             + text + "'");
}

Read<std::string>
with_track(std::string_view playlist, const std::string &uri, const std::string &ahap_address,
           bool force)
{
  constexpr const char *kGroup = "tactile";
  std::vector<std::string> lines;
  std::set<std::string> groups;
  for (const std::string_view line : lines_of(playlist)) {
    if (line.starts_with("#EXT-X-MEDIA:") && attribute(line, "URI") == uri)
      continue;
    if (line.starts_with("#EXT-X-SESSION-DATA:") && attribute(line, "DATA-ID") == kHaptics
        && !attribute(line, "LANGUAGE")) {
      const std::string address = attribute(line, "VALUE").value_or("");
      if (!force && address.substr(address.rfind('/') + 1) != kAhapName)
        return expected("no haptics but tactile-track's (--force replaces them), got '"
                        + std::string(line) + "'");
      continue;
    }
    lines.emplace_back(line);
    if (!line.starts_with(kVariant))
      continue;
    const std::optional<std::string> group = attribute(line, "SUBTITLES");
    groups.insert(group.value_or(kGroup));
    if (!group)
      lines.back() += std::string(",SUBTITLES=\"") + kGroup + "\"";
  }
  std::vector<std::string> ours;
  for (const std::string &group : groups)
    ours.push_back(
        "#EXT-X-MEDIA:TYPE=SUBTITLES,GROUP-ID=\"" + group
        + "\",NAME=\"Tactile\",LANGUAGE=\"zxx\",DEFAULT=NO,AUTOSELECT=NO,FORCED=NO,URI=\"" + uri
        + "\"");
  if (!ahap_address.empty())
    ours.push_back("#EXT-X-SESSION-DATA:DATA-ID=\"" + std::string(kHaptics) + "\",VALUE=\""
                   + ahap_address + "\"");
  const auto first = std::ranges::find_if(
      lines, [](const std::string &line) { return line.starts_with(kVariant); });
  lines.insert(first, ours.begin(), ours.end());
  std::string text;
  for (const std::string &line : lines)
    text += line + "\n";
  return text;
}

Read<Segments>
read_segments(std::string_view playlist)
{
  std::vector<std::string_view> lines = lines_of(playlist);
  // A file that is being written. Its last line needs no end where nothing follows it.
  if (!lines.empty() && !playlist.ends_with('\n') && lines.back() != "#EXT-X-ENDLIST")
    lines.pop_back();
  if (lines.empty() || lines.front() != "#EXTM3U")
    return expected("#EXTM3U in the first line");
  Segments segments;
  std::optional<Time> duration; // of the next URI
  std::string date;
  for (const std::string_view line : lines) {
    const std::string_view value = line.substr(line.find(':') + 1);
    const auto refused = [line](const std::string &what) {
      return expected(what + ", got '" + std::string(line.substr(0, 40)) + "'");
    };
    if (line.starts_with("#EXTINF:")) {
      const auto length = number<double>(value, ',');
      if (!length || !(*length >= 0 && *length <= kLongest))
        return refused("#EXTINF with 0 to 3600 s");
      if (duration)
        return refused("a URI after #EXTINF");
      duration = seconds(*length);
    } else if (line.starts_with("#EXT-X-MEDIA-SEQUENCE:")) {
      const auto sequence = number<std::int64_t>(value);
      if (!sequence || *sequence < 0 || *sequence > std::int64_t{ 1 } << 53)
        return refused("a number");
      segments.sequence = *sequence;
    } else if (line.starts_with("#EXT-X-TARGETDURATION:")) {
      const auto target = number<std::int64_t>(value);
      if (!target || *target < 0 || static_cast<double>(*target) > kLongest)
        return refused("0 to 3600 s");
      segments.target = *target;
    } else if (line.starts_with("#EXT-X-PLAYLIST-TYPE:")) {
      if (value != "VOD" && value != "EVENT")
        return refused("VOD or EVENT");
      segments.type = value;
    } else if (line.starts_with("#EXT-X-PROGRAM-DATE-TIME:")) {
      if (line.size() > kMostDate)
        return refused("a date");
      date = line;
    } else if (line.starts_with("#EXT-X-DISCONTINUITY")
               && line != "#EXT-X-DISCONTINUITY-SEQUENCE:0") {
      return refused("time stamps that go on");
    } else if (line == "#EXT-X-ENDLIST") {
      segments.is_ended = true;
    } else if (duration && !line.empty() && !line.starts_with('#')) {
      if (segments.durations.size() == kMostSegments)
        return expected("at most " + std::to_string(kMostSegments) + " segments");
      segments.durations.push_back(*std::exchange(duration, std::nullopt));
      segments.dates.push_back(std::exchange(date, {}));
    }
  }
  if (segments.target < 0)
    return expected("#EXT-X-TARGETDURATION");
  return segments;
}

Read<Rendition>
begun(Segments now)
{
  // With a type, no segment has left the playlist.
  if (now.sequence > 0 && now.type.empty())
    return expected("a film's first segments, got a playlist without a type that begins with "
                    "segment "
                    + std::to_string(now.sequence) + "; start tactile-track with the stream");
  return Rendition{ .segments = std::move(now) };
}

std::int64_t
oldest_kept(const Segments &segments)
{
  return segments.sequence - static_cast<std::int64_t>(segments.durations.size()) - 1;
}

std::string
write_rendition(const Rendition &rendition)
{
  const Segments &segments = rendition.segments;
  std::string text
      = "#EXTM3U\n#EXT-X-VERSION:3\n#EXT-X-TARGETDURATION:" + std::to_string(segments.target)
        + "\n#EXT-X-MEDIA-SEQUENCE:" + std::to_string(segments.sequence) + "\n"
        + (segments.type.empty() ? "" : "#EXT-X-PLAYLIST-TYPE:" + segments.type + "\n")
        + std::string(kState) + std::to_string(rendition.start) + " " + text_of(rendition.first)
        + "\n";
  for (std::size_t i = 0; i < segments.durations.size(); i++)
    text += (segments.dates[i].empty() ? "" : segments.dates[i] + "\n")
            + "#EXTINF:" + text_of(segments.durations[i]) + ",\n"
            + std::to_string(segments.sequence + static_cast<std::int64_t>(i)) + ".vtt\n";
  return segments.is_ended ? text + "#EXT-X-ENDLIST\n" : text;
}

Read<Rendition>
read_rendition(std::string_view playlist)
{
  auto segments = read_segments(playlist);
  if (!segments)
    return tl::unexpected(segments.error());
  for (std::string_view line : lines_of(playlist)) {
    if (!line.starts_with(kState))
      continue;
    line.remove_prefix(kState.size());
    const auto start = number<std::int64_t>(line, ' ');
    const auto first = number<double>(line.substr(std::min(line.find(' '), line.size() - 1) + 1));
    if (start && first && *first >= 0 && *first <= 1e9)
      return Rendition{ .segments = *std::move(segments),
                        .start = *start,
                        .first = seconds(*first) };
  }
  return expected("a playlist of tactile-track");
}

Read<Rendition>
followed(const Rendition &before, Segments now)
{
  const std::int64_t gone = now.sequence - before.segments.sequence;
  const std::vector<Time> &durations = before.segments.durations;
  if (gone < 0 || static_cast<std::size_t>(gone) > durations.size())
    return expected("a playlist that goes on from segment "
                    + std::to_string(before.segments.sequence) + ", got "
                    + std::to_string(now.sequence)
                    + "; remove the folder of the rendition to begin " + "anew");
  const Time first = std::accumulate(durations.begin(), durations.begin() + gone, before.first);
  return Rendition{ .segments = std::move(now), .start = before.start, .first = first };
}

} // namespace hls
