// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hls_playlist.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>
#include <set>

namespace hls {

namespace {

constexpr std::size_t kMostSegments = 1'000'000;
constexpr double kLongest = 3600; ///< s

constexpr std::string_view kVariant = "#EXT-X-STREAM-INF:";
constexpr std::string_view kHaptics = "com.apple.hls.haptics.url";
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
    if (line.ends_with('\r'))
      line.remove_suffix(1);
    lines.push_back(line);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return lines;
}

template <typename Number>
std::optional<Number>
number(std::string_view text)
{
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() ? std::optional(value) : std::nullopt;
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

std::string
with_track(std::string_view playlist, const std::string &uri, const std::string &ahap_address)
{
  constexpr const char *kGroup = "tactile";
  std::vector<std::string> lines;
  std::set<std::string> groups;
  for (const std::string_view line : lines_of(playlist)) {
    if ((line.starts_with("#EXT-X-MEDIA:") && attribute(line, "URI") == uri)
        || (line.starts_with("#EXT-X-SESSION-DATA:") && attribute(line, "DATA-ID") == kHaptics))
      continue;
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
  const std::vector<std::string_view> lines = lines_of(playlist);
  if (lines.empty() || lines.front() != "#EXTM3U")
    return expected("#EXTM3U in the first line");
  Segments segments;
  const auto value = [](std::string_view line) {
    return line.substr(line.find(':') + 1);
  };
  for (const std::string_view line : lines) {
    if (line.starts_with("#EXTINF:")) {
      const auto duration = number<double>(value(line));
      if (!duration || !(*duration >= 0 && *duration <= kLongest))
        return expected("#EXTINF with 0 to 3600 s, got '" + std::string(line.substr(0, 40)) + "'");
      if (segments.durations.size() == kMostSegments)
        return expected("at most " + std::to_string(kMostSegments) + " segments");
      segments.durations.push_back(seconds(*duration));
    } else if (line.starts_with("#EXT-X-MEDIA-SEQUENCE:")) {
      const auto sequence = number<std::int64_t>(value(line));
      if (!sequence || *sequence < 0 || *sequence > std::int64_t{ 1 } << 53)
        return expected("a number in '" + std::string(line.substr(0, 40)) + "'");
      segments.sequence = *sequence;
    } else if (line == "#EXT-X-DISCONTINUITY") {
      return expected("time stamps that go on, got #EXT-X-DISCONTINUITY");
    } else if (line == "#EXT-X-ENDLIST") {
      segments.is_ended = true;
    }
  }
  return segments;
}

std::string
write_rendition(const Rendition &rendition)
{
  const Segments &segments = rendition.segments;
  Time longest = std::chrono::seconds(1);
  for (const Time duration : segments.durations)
    longest = std::max(longest, duration);
  std::string text = "#EXTM3U\n#EXT-X-VERSION:3\n#EXT-X-TARGETDURATION:"
                     + std::to_string(std::chrono::round<std::chrono::seconds>(longest).count())
                     + "\n#EXT-X-MEDIA-SEQUENCE:" + std::to_string(segments.sequence) + "\n"
                     + std::string(kState) + std::to_string(rendition.start) + " "
                     + text_of(rendition.first) + "\n";
  for (std::size_t i = 0; i < segments.durations.size(); i++)
    text += "#EXTINF:" + text_of(segments.durations[i]) + ",\n"
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
    const auto start = number<std::int64_t>(line);
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
