// SPDX-License-Identifier: LGPL-2.1-or-later
#include "film_contents.h"

#include "film/program.h"
#include "translation.h"
#include "json/json_reader.h"

#include <glib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string_view>

namespace json = visuotactile::json;

namespace {

/// Tags that a muxer writes of itself.
constexpr std::array kOwnTags = { "encoder",
                                  "software",
                                  "major_brand",
                                  "minor_version",
                                  "compatible_brands",
                                  "handler_name",
                                  "vendor_id",
                                  "duration",
                                  "bps",
                                  "number_of_frames",
                                  "number_of_bytes",
                                  "source_id",
                                  "bitsps",
                                  "encoder-eng",
                                  "duration-eng",
                                  "rotate",      // the display matrix says it
                                  "stereo_mode", // "stereo 3d" says it
                                  "bps-eng",
                                  "source_id-eng",
                                  "number_of_frames-eng",
                                  "number_of_bytes-eng" };

/// Values that say nothing.
constexpr std::array kUnknown = { "", "N/A", "unknown", "und", "unspecified", "tv" };

/// What a player needs of a stream's format, apart from its codec's data.
constexpr std::array kFormat = { "width",          "height",          "color_range", "color_space",
                                 "color_transfer", "color_primaries", "sample_rate", "channels" };

/// Packets of a stream's beginning: pictures may be decoded before earlier ones. Later times may
/// step back in a recording, and are not used.
constexpr int kFirst = 64;

struct ParserUnref
{
  void operator()(JsonParser *parser) const
  {
    g_object_unref(parser);
  }
};

std::string
lower(std::string_view text)
{
  std::string low(text);
  std::ranges::transform(low, low.begin(), g_ascii_tolower);
  return low;
}

/// A member as text, whatever its type.
std::string
value(JsonObject *of, const char *name)
{
  JsonNode *node = json_object_get_member(of, name);
  if (node == nullptr || !JSON_NODE_HOLDS_VALUE(node))
    return {};
  if (json_node_get_value_type(node) == G_TYPE_STRING)
    return json_node_get_string(node);
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.15g", json_node_get_double(node));
  return text.data();
}

double
number(JsonObject *of, const char *name)
{
  const std::string text = value(of, name);
  double result = FilmStream::kNever;
  std::from_chars(text.data(), text.data() + text.size(), result);
  return result;
}

/// Containers have fractions with other denominators, and floats.
std::string
rounded(const std::string &text)
{
  double above = 0;
  double below = 1;
  const char *const end = text.data() + text.size();
  auto [stop, error] = std::from_chars(text.data(), end, above);
  if (error == std::errc() && stop != end && *stop == '/')
    stop = std::from_chars(stop + 1, end, below).ptr;
  if (error != std::errc() || stop != end || below == 0)
    return text;
  std::array<char, 32> number{};
  std::snprintf(number.data(), number.size(), "%.3g", above / below);
  return number.data();
}

void
add(Facts &facts, const std::string &name, const std::string &text)
{
  if (std::ranges::find(kUnknown, text) == kUnknown.end())
    facts[name] = text;
}

template <typename Visit>
void
for_each_member(JsonObject *object, Visit visit)
{
  if (object == nullptr)
    return;
  g_autoptr(GList) names = json_object_get_members(object);
  for (const GList *item = names; item != nullptr; item = item->next)
    visit(static_cast<const char *>(item->data));
}

void
add_tags(Facts &facts, JsonObject *of)
{
  JsonObject *tags = json::object(of, "tags");
  for_each_member(tags, [&](const char *name) {
    const std::string low = lower(name);
    if (std::ranges::find(kOwnTags, low) == kOwnTags.end() && !low.starts_with("_statistics"))
      add(facts, low, low == "creation_time" ? value(tags, name).substr(0, 19) : value(tags, name));
  });
}

/// MP4 has a name for the handler alone.
void
add_handler_as_title(Facts &facts, JsonObject *stream)
{
  JsonObject *tags = json::object(stream, "tags");
  const std::string handler = tags != nullptr ? value(tags, "handler_name") : "";
  if (!facts.contains("title") && !handler.empty() && !handler.ends_with("Handler")
      && !handler.starts_with("Core Media"))
    add(facts, "handler", handler);
}

void
add_side_data(Facts &facts, JsonObject *stream)
{
  JsonArray *list = json::array(stream, "side_data_list");
  for (guint i = 0; list != nullptr && i < json_array_get_length(list); i++) {
    JsonObject *one = json::object(list, i);
    const std::string type = one != nullptr ? value(one, "side_data_type") : "";
    if (type.empty() || type == "CPB properties")
      continue;
    std::string text;
    for_each_member(one, [&](const char *name) {
      const std::string_view member = name;
      if (member != "side_data_type" && member != "displaymatrix")
        text += std::string(text.empty() ? "" : " ") + name + "=" + rounded(value(one, name));
    });
    facts[lower(type)] = text.empty() ? "yes" : text;
  }
}

FilmStream
stream_of(JsonObject *from)
{
  FilmStream stream{ .kind = value(from, "codec_type"), .codec = value(from, "codec_name") };
  if (const std::string id = value(from, "id"); id.starts_with("0x"))
    std::from_chars(id.data() + 2, id.data() + id.size(), stream.id, 16);
  if (stream.codec == "mp2")
    stream.codec = "mp3"; // of one type in MP4
  if (stream.codec.empty())
    stream.codec = value(from, "codec_tag_string");
  if (stream.kind == "data" && value(from, "codec_tag_string") == "text")
    stream.kind = FilmStream::kChapters;
  for (const char *name : kFormat)
    add(stream.facts, name, value(from, name));
  std::string pixel = value(from, "sample_aspect_ratio");
  std::ranges::replace(pixel, ':', '/');
  if (pixel != "1/1" && pixel != "0/1")
    add(stream.facts, "sample_aspect_ratio", rounded(pixel));
  if (stream.kind == "attachment")
    add(stream.facts, "size", value(from, "extradata_size"));
  JsonObject *flags = json::object(from, "disposition");
  for_each_member(flags, [&](const char *name) {
    if (value(flags, name) == "1")
      stream.facts[std::string("flag ") + name] = "yes";
  });
  add_tags(stream.facts, from);
  add_handler_as_title(stream.facts, from);
  add_side_data(stream.facts, from);
  return stream;
}

/// More streams no film has.
constexpr long kMostStreams = 4096;

/// A number of a line such as `{ "stream_index": 0, "pts_time": "1.001000", "size": "872" }`.
template <typename Number>
bool
read_field(std::string_view line, std::string_view name, Number &number)
{
  const std::size_t at = line.find(name);
  if (at == std::string_view::npos)
    return false;
  std::string_view text = line.substr(at + name.size());
  text.remove_prefix(std::min(text.find_first_not_of("\": "), text.size()));
  return std::from_chars(text.data(), text.data() + text.size(), number).ec == std::errc();
}

} // namespace

bool
FilmStream::is_picture() const
{
  return kind == "video" && !facts.contains("flag attached_pic");
}

bool
FilmStream::is_text() const
{
  constexpr std::array kText = { "subrip", "ass", "ssa", "mov_text", "webvtt", "text" };
  return kind == "subtitle" && std::ranges::find(kText, codec) != kText.end();
}

bool
FilmStream::is_tactile() const
{
  const auto is = [&](const char *name, const char *expected) {
    const auto found = facts.find(name);
    return found != facts.end() && found->second == expected;
  };
  return kind == "subtitle" && is("language", "zxx")
         && (is("title", "Tactile") || is("handler", "Tactile"));
}

bool
FilmContents::lacks_times() const
{
  return std::ranges::any_of(streams, [](const FilmStream &stream) {
    return (stream.kind == "video" || stream.kind == "audio")
           && std::ranges::any_of(stream.packets, [](const FilmStream::Packet &packet) {
                return std::isnan(packet.time);
              });
  });
}

bool
FilmContents::is_in(const char *format) const
{
  return ("," + container + ",").find("," + std::string(format) + ",") != std::string::npos;
}

double
FilmContents::earliest() const
{
  double least = HUGE_VAL;
  for (const FilmStream &stream : streams)
    if (stream.kind == "audio" || stream.is_picture())
      for (int count = 0; const FilmStream::Packet &packet : stream.packets) {
        if (std::isnan(packet.time))
          continue;
        least = std::min(least, packet.time);
        if (++count == kFirst)
          break;
      }
  return std::isinf(least) ? 0 : least;
}

FilmContents
read_contents(const std::string &path, const std::function<void(double)> &on_progress)
{
  std::error_code unknown;
  const auto size = static_cast<double>(std::filesystem::file_size(path, unknown));
  std::string text;
  std::vector<std::vector<FilmStream::Packet>> packets;
  int percent = 0;
  bool is_in_packets = false;
  // "packets" comes before all else and has a line a packet, and more for its side data.
  const ProgramEnd end = run_program(
      { "ffprobe", "-v", "error", "-probesize", "50M", "-analyzeduration", "50M", "-show_format",
        "-show_streams", "-show_chapters", "-show_entries", "packet=stream_index,pts_time,size,pos",
        "-of", "json=compact=1", "file:" + path },
      "ffmpeg", [&](std::string_view line) {
        if (!is_in_packets) {
          is_in_packets = line == "    \"packets\": [";
          if (!is_in_packets)
            text.append(line).append("\n");
          return;
        }
        is_in_packets = line != "    ],";
        long stream = 0;
        if (!read_field(line, "\"stream_index\"", stream) || stream < 0 || stream >= kMostStreams)
          return;
        if (packets.size() <= static_cast<std::size_t>(stream))
          packets.resize(static_cast<std::size_t>(stream) + 1);
        FilmStream::Packet &packet = packets[static_cast<std::size_t>(stream)].emplace_back();
        if (!read_field(line, "\"pts_time\"", packet.time))
          packet.time = FilmStream::kNever;
        read_field(line, "\"size\"", packet.size);
        double at = 0;
        if (!unknown && read_field(line, "\"pos\"", at)
            && static_cast<int>(100 * at / size) > percent) {
          percent = static_cast<int>(100 * at / size);
          on_progress(std::min(at / size, 1.0));
        }
      });
  const std::unique_ptr<JsonParser, ParserUnref> parser(json::parse(text));
  JsonNode *root = parser ? json_parser_get_root(parser.get()) : nullptr;
  JsonObject *all = root && JSON_NODE_HOLDS_OBJECT(root) ? json_node_get_object(root) : nullptr;
  JsonObject *format = all ? json::object(all, "format") : nullptr;
  JsonArray *streams = all ? json::array(all, "streams") : nullptr;
  if (end.status != 0 || !format || !streams)
    throw std::runtime_error(
        in_text("'{}' is not a film that FFmpeg can read: {}", path, end.complaint));
  FilmContents contents{ .container = value(format, "format_name") };
  const double start = number(format, "start_time");
  contents.start = std::isnan(start) ? 0 : start;
  const double duration = number(format, "duration");
  contents.duration = std::isnan(duration) ? 0 : duration;
  add_tags(contents.facts, format);
  const auto date = contents.facts.find("creation_time");
  for (guint i = 0; i < json_array_get_length(streams); i++)
    if (JsonObject *one = json::object(streams, i)) {
      FilmStream &stream = contents.streams.emplace_back(stream_of(one));
      // MP4 says the film's for each stream, Matroska once.
      if (const auto of = stream.facts.find("creation_time");
          of != stream.facts.end() && date != contents.facts.end() && of->second == date->second)
        stream.facts.erase(of);
      if (i < packets.size())
        stream.packets = std::move(packets[i]);
      if (stream.codec == "mov_text") // MP4 fills gaps between subtitles with empty ones
        std::erase_if(stream.packets, [](const auto &packet) { return packet.size <= 2; });
    }
  JsonArray *chapters = json::array(all, "chapters");
  for (guint i = 0; chapters && i < json_array_get_length(chapters); i++)
    if (JsonObject *one = json::object(chapters, i)) {
      Facts tags;
      add_tags(tags, one);
      contents.chapters.push_back({ .start = number(one, "start_time"), .title = tags["title"] });
    }
  return contents;
}
