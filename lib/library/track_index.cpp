// SPDX-License-Identifier: LGPL-2.1-or-later
#include "library/track_index.h"

#include "json/json_reader.h"

#include <algorithm>
#include <cmath>

namespace library {

namespace json = visuotactile::json;

namespace {

constexpr guint kMostTracks = 100'000;
constexpr std::size_t kLongestName = 1024;
constexpr double kLongest = 360'000; ///< seconds, as of tracks

bool
is_clean(const std::string &name)
{
  return name.size() <= kLongestName && g_utf8_validate(name.data(), gssize(name.size()), nullptr)
         && std::ranges::none_of(name, [](char c) { return g_ascii_iscntrl(c) || c == '\\'; });
}

/// A path below the index. No part is empty or begins with a dot, so that none leads elsewhere.
bool
is_below(const std::string &path)
{
  return !path.empty() && is_clean(path) && !path.starts_with('/') && !path.starts_with('.')
         && !path.ends_with('/') && path.find("/.") == std::string::npos
         && path.find("//") == std::string::npos && path.find(':') == std::string::npos;
}

bool
is_sum(const std::string &text)
{
  return text.empty() || (text.size() == 64 && std::ranges::all_of(text, [](char c) {
                            return g_ascii_isxdigit(c) && !g_ascii_isupper(c);
                          }));
}

} // namespace

tl::expected<std::vector<IndexEntry>, std::string>
read_index(std::string_view text)
{
  if (text.size() > kMostIndex)
    return tl::unexpected("expected at most " + std::to_string(kMostIndex) + " bytes");
  g_autoptr(JsonParser) parser = json::parse(text);
  JsonNode *root = parser != nullptr ? json_parser_get_root(parser) : nullptr;
  JsonArray *tracks = root != nullptr && JSON_NODE_HOLDS_OBJECT(root)
                          ? json::array(json_node_get_object(root), "tracks")
                          : nullptr;
  if (tracks == nullptr)
    return tl::unexpected<std::string>("expected JSON with an array 'tracks'");
  const guint count = json_array_get_length(tracks);
  if (count > kMostTracks)
    return tl::unexpected("expected at most " + std::to_string(kMostTracks) + " tracks, got "
                          + std::to_string(count));
  std::vector<IndexEntry> entries;
  entries.reserve(count);
  for (guint i = 0; i < count; i++) {
    const std::string place = "track " + std::to_string(i + 1) + ": expected ";
    JsonObject *object = json::object(tracks, i);
    if (object == nullptr)
      return tl::unexpected(place + "an object");
    IndexEntry entry{ .file = json::name_of_file(object, "file"),
                      .film = json::name_of_file(object, "film"),
                      .content = json::name_of_file(object, "content"),
                      .heard = json::name_of_file(object, "heard"),
                      .heard_sum = json::name_of_file(object, "heard_sum") };
    const double duration = json::number(object, "duration").value_or(-1);
    if (!is_below(entry.file))
      return tl::unexpected(place + "'file', a path below the index without '..'");
    if (!is_clean(entry.film) || entry.film.find('/') != std::string::npos)
      return tl::unexpected(place + "'film', the name of a file");
    if (!is_sum(entry.content))
      return tl::unexpected(place + "'content', 64 hexadecimal digits");
    if (!entry.heard.empty() && !is_below(entry.heard))
      return tl::unexpected(place + "'heard', a path below the index without '..'");
    if (!is_sum(entry.heard_sum) || entry.heard.empty() != entry.heard_sum.empty())
      return tl::unexpected(place + "'heard_sum', 64 hexadecimal digits, with 'heard'");
    if (!(duration >= 0 && duration <= kLongest))
      return tl::unexpected(place + "'duration', seconds up to 100 hours");
    entry.duration = visuotactile::Time(std::llround(duration * 1e9));
    entries.push_back(std::move(entry));
  }
  return entries;
}

std::string
write_index(const std::vector<IndexEntry> &entries)
{
  g_autoptr(JsonBuilder) builder = json_builder_new();
  const auto add = [&](const char *name, const std::string &value) {
    if (value.empty())
      return;
    json_builder_set_member_name(builder, name);
    json_builder_add_string_value(builder, value.c_str());
  };
  json_builder_begin_object(builder);
  json_builder_set_member_name(builder, "tracks");
  json_builder_begin_array(builder);
  for (const IndexEntry &entry : entries) {
    json_builder_begin_object(builder);
    add("file", entry.file);
    json_builder_set_member_name(builder, "duration");
    json_builder_add_double_value(builder, static_cast<double>(entry.duration.count()) / 1e9);
    add("film", entry.film);
    add("content", entry.content);
    add("heard", entry.heard);
    add("heard_sum", entry.heard_sum);
    json_builder_end_object(builder);
  }
  json_builder_end_array(builder);
  json_builder_end_object(builder);
  JsonNode *root = json_builder_get_root(builder);
  g_autoptr(JsonGenerator) generator = json_generator_new();
  json_generator_set_pretty(generator, TRUE);
  json_generator_set_root(generator, root);
  g_autofree gchar *text = json_generator_to_data(generator, nullptr);
  json_node_unref(root);
  return std::string(text) + "\n";
}

} // namespace library
