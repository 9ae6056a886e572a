// SPDX-License-Identifier: LGPL-2.1-or-later
#include "desk/messages.h"

#include "json/json_reader.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

namespace desk {

namespace {

namespace json = visuotactile::json;

constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kMostFrequency = 1000; ///< Hz
constexpr std::size_t kLongestName = 64;
constexpr int kMostCells = tactile::kMaxGridSide * tactile::kMaxGridSide;

tl::unexpected<std::string>
expected(std::string what)
{
  return tl::unexpected("expected " + std::move(what));
}

using Message = json::ObjectText;

constexpr const char *kAnObject = "a JSON object in UTF-8";

std::optional<std::string>
string_of(JsonNode *node)
{
  if (!node || !JSON_NODE_HOLDS_VALUE(node) || json_node_get_value_type(node) != G_TYPE_STRING)
    return std::nullopt;
  return json_node_get_string(node);
}

std::optional<std::string>
name_of(JsonObject *object, const char *member)
{
  std::optional<std::string> name = string_of(json_object_get_member(object, member));
  return name && is_name(*name) ? name : std::nullopt;
}

std::optional<int>
integer_of(JsonNode *node, int most)
{
  if (!node || !JSON_NODE_HOLDS_VALUE(node) || json_node_get_value_type(node) != G_TYPE_INT64)
    return std::nullopt;
  const gint64 value = json_node_get_int(node);
  return value >= 0 && value <= most ? std::optional(static_cast<int>(value)) : std::nullopt;
}

/// Integers from 0 to `most`; none if it is something else.
template <typename Integer>
std::optional<std::vector<Integer>>
integers(JsonArray *array, int most)
{
  if (!array || json_array_get_length(array) > static_cast<guint>(kMostCells))
    return std::nullopt;
  std::vector<Integer> values;
  values.reserve(json_array_get_length(array));
  for (guint i = 0; i < json_array_get_length(array); i++) {
    const std::optional<int> value = integer_of(json_array_get_element(array, i), most);
    if (!value)
      return std::nullopt;
    values.push_back(static_cast<Integer>(*value));
  }
  return values;
}

std::optional<std::int32_t>
time_of(JsonObject *object, const char *name)
{
  const auto time = json::integer(object, name, 0, kLatest);
  return time ? std::optional(static_cast<std::int32_t>(*time)) : std::nullopt;
}

Read<Cue>
read_cue(JsonObject *object)
{
  const auto start = object ? time_of(object, "start") : std::nullopt;
  const auto end = object ? time_of(object, "end") : std::nullopt;
  if (!start || !end)
    return expected("a cue with start and end in whole ms from 0 to " + std::to_string(kLatest));
  auto levels = integers<std::uint8_t>(json::array(object, "levels"), kMostPercent);
  if (!levels)
    return expected("levels in whole percent from 0 to 100");
  const auto frequency = json_object_has_member(object, "frequency")
                             ? json::integer(object, "frequency", 0, kMostFrequency)
                             : 0;
  if (!frequency)
    return expected("a frequency in whole Hz from 0 to " + std::to_string(kMostFrequency));
  Cue cue{ .start = *start,
           .end = *end,
           .levels = *std::move(levels),
           .frequency = static_cast<std::int32_t>(*frequency),
           .notes = {} };
  JsonArray *notes = json::array(object, "notes");
  if (!notes && json_object_has_member(object, "notes"))
    return expected("notes in an array");
  for (guint i = 0; notes && i < json_array_get_length(notes); i++) {
    std::optional<std::string> note = string_of(json_array_get_element(notes, i));
    if (!note || cue.notes.size() == tactile::kMostWebvttNotes)
      return expected("at most " + std::to_string(tactile::kMostWebvttNotes)
                      + " notes, each a text");
    cue.notes.push_back(*std::move(note));
  }
  return cue;
}

Read<Splice>
read_splice(JsonObject *object)
{
  const auto at = object ? json::integer(object, "at", 0, kMost) : std::nullopt;
  const auto remove = object ? json::integer(object, "remove", 0, kMost) : std::nullopt;
  JsonArray *insert = object ? json::array(object, "insert") : nullptr;
  if (!at || !remove || !insert)
    return expected("splices with at, remove and insert");
  Splice splice{ .at = static_cast<std::size_t>(*at),
                 .remove = static_cast<std::size_t>(*remove),
                 .insert = {} };
  const guint count = json_array_get_length(insert);
  if (count > kMostCues)
    return expected("at most " + std::to_string(kMostCues) + " cues");
  splice.insert.reserve(count);
  for (guint i = 0; i < count; i++) {
    Read<Cue> cue = read_cue(json::object(insert, i));
    if (!cue)
      return tl::unexpected(cue.error());
    splice.insert.push_back(*std::move(cue));
  }
  return splice;
}

Read<Selection>
read_selection(JsonObject *object)
{
  Selection selection;
  if (!object)
    return selection;
  for (const auto &[name, time] :
       { std::pair("from", &selection.from), std::pair("to", &selection.to) }) {
    if (!json_object_has_member(object, name))
      continue;
    *time = time_of(object, name);
    if (!*time)
      return expected(std::string("selection.") + name + " in whole ms");
  }
  if (json_object_has_member(object, "cells")) {
    auto cells = integers<int>(json::array(object, "cells"), kMostCells - 1);
    if (!cells)
      return expected("selection.cells, indices of cells from 0");
    selection.cells = *std::move(cells);
  }
  return selection;
}

JsonBuilder *
begin_cue(JsonBuilder *builder, const Cue &cue)
{
  json_builder_begin_object(builder);
  json_builder_add_int_value(json_builder_set_member_name(builder, "start"), cue.start);
  json_builder_add_int_value(json_builder_set_member_name(builder, "end"), cue.end);
  json_builder_begin_array(json_builder_set_member_name(builder, "levels"));
  for (const int level : cue.levels)
    json_builder_add_int_value(builder, level);
  json_builder_end_array(builder);
  if (cue.frequency > 0)
    json_builder_add_int_value(json_builder_set_member_name(builder, "frequency"), cue.frequency);
  if (!cue.notes.empty()) {
    json_builder_begin_array(json_builder_set_member_name(builder, "notes"));
    for (const std::string &note : cue.notes)
      json_builder_add_string_value(builder, note.c_str());
    json_builder_end_array(builder);
  }
  return json_builder_end_object(builder);
}

void
add_cues(JsonBuilder *builder, const std::vector<Cue> &cues)
{
  json_builder_begin_array(builder);
  for (const Cue &cue : cues)
    begin_cue(builder, cue);
  json_builder_end_array(builder);
}

void
add_splices(JsonBuilder *builder, const std::vector<Splice> &splices)
{
  json_builder_begin_array(builder);
  for (const Splice &splice : splices) {
    json_builder_begin_object(builder);
    json_builder_add_int_value(json_builder_set_member_name(builder, "at"),
                               static_cast<gint64>(splice.at));
    json_builder_add_int_value(json_builder_set_member_name(builder, "remove"),
                               static_cast<gint64>(splice.remove));
    add_cues(json_builder_set_member_name(builder, "insert"), splice.insert);
    json_builder_end_object(builder);
  }
  json_builder_end_array(builder);
}

std::string
written(JsonBuilder *builder)
{
  g_autoptr(JsonNode) root = json_builder_get_root(builder);
  g_autoptr(JsonGenerator) generator = json_generator_new();
  json_generator_set_root(generator, root);
  gsize length = 0;
  g_autofree gchar *text = json_generator_to_data(generator, &length);
  return { text, length };
}

} // namespace

bool
is_name(std::string_view text)
{
  return !text.empty() && text.size() <= kLongestName
         && std::ranges::all_of(text, [](char c) { return g_ascii_isalnum(c); });
}

Read<EditMessage>
read_edit(std::string_view body)
{
  const Message message(body);
  JsonObject *object = message.object();
  if (!object)
    return expected(kAnObject);
  auto page = name_of(object, "page");
  auto edit = name_of(object, "edit");
  const auto revision = json::integer(object, "revision", 0, kMost);
  JsonArray *splices = json::array(object, "splices");
  if (!page || !edit || !revision || !splices)
    return expected("page, edit, revision and splices");
  EditMessage result{ .page = *std::move(page),
                      .edit = *std::move(edit),
                      .revision = static_cast<std::uint64_t>(*revision),
                      .splices = {} };
  const guint count = json_array_get_length(splices);
  if (count > kMostCues)
    return expected("at most " + std::to_string(kMostCues) + " splices");
  for (guint i = 0; i < count; i++) {
    Read<Splice> splice = read_splice(json::object(splices, i));
    if (!splice)
      return tl::unexpected(splice.error());
    result.splices.push_back(*std::move(splice));
  }
  return result;
}

std::string
write_edit(const EditMessage &message)
{
  g_autoptr(JsonBuilder) builder = json_builder_new_immutable();
  json_builder_begin_object(builder);
  json_builder_add_string_value(json_builder_set_member_name(builder, "page"),
                                message.page.c_str());
  json_builder_add_string_value(json_builder_set_member_name(builder, "edit"),
                                message.edit.c_str());
  json_builder_add_int_value(json_builder_set_member_name(builder, "revision"),
                             static_cast<gint64>(message.revision));
  add_splices(json_builder_set_member_name(builder, "splices"), message.splices);
  json_builder_end_object(builder);
  return written(builder);
}

Read<OperationMessage>
read_operation(std::string_view body)
{
  const Message message(body);
  JsonObject *object = message.object();
  if (!object)
    return expected(kAnObject);
  const auto revision = json::integer(object, "revision", 0, kMost);
  auto name = string_of(json_object_get_member(object, "operation"));
  if (!revision || !name)
    return expected("revision and operation");
  OperationMessage result{ .revision = static_cast<std::uint64_t>(*revision), .operation = {} };
  result.operation.name = *std::move(name);
  if (JsonArray *pair = json::array(object, "value"); pair && json_array_get_length(pair) == 2) {
    for (guint i = 0; i < 2; i++) {
      JsonNode *node = json_array_get_element(pair, i);
      if (!JSON_NODE_HOLDS_VALUE(node)
          || (json_node_get_value_type(node) != G_TYPE_INT64
              && json_node_get_value_type(node) != G_TYPE_DOUBLE))
        return expected("two numbers as value");
      (i == 0 ? result.operation.value : result.operation.second) = json_node_get_double(node);
    }
  } else if (json_object_has_member(object, "value")
             && !json_object_get_null_member(object, "value")) {
    const std::optional<double> value = json::number(object, "value");
    if (!value)
      return expected("a number as value, or two");
    result.operation.value = *value;
  }
  Read<Selection> selection = read_selection(json::object(object, "selection"));
  if (!selection)
    return tl::unexpected(selection.error());
  result.operation.selection = *std::move(selection);
  return result;
}

Read<PageMessage>
read_page(std::string_view body)
{
  const Message message(body);
  auto page = message.object() ? name_of(message.object(), "page") : std::nullopt;
  if (!page)
    return expected("a JSON object with page, a name of 1 to 64 letters and digits");
  return PageMessage{ .page = *std::move(page),
                      .take = json::truth(message.object(), "take").value_or(false),
                      .give = json::truth(message.object(), "give").value_or(false),
                      .over = json::truth(message.object(), "over").value_or(false) };
}

Read<PositionMessage>
read_position(std::string_view body)
{
  constexpr double kMostRate = 16;
  const Message message(body);
  JsonObject *object = message.object();
  auto page = object ? name_of(object, "page") : std::nullopt;
  const auto position = object ? json::number(object, "position") : std::nullopt;
  const double rate = object ? json::number(object, "rate").value_or(1) : 1;
  if (!page || !position || !(*position >= 0 && *position <= kLatest)
      || !(rate >= -kMostRate && rate <= kMostRate))
    return expected("page, position in ms and rate");
  return PositionMessage{ .page = *std::move(page),
                          .position = *position,
                          .rate = rate,
                          .paused = json::truth(object, "paused").value_or(false),
                          .leap = json::truth(object, "leap").value_or(false) };
}

Read<FeelMessage>
read_feel(std::string_view body)
{
  constexpr int kLeast = 20;
  constexpr int kLongest = 2000;
  const Message message(body);
  JsonObject *object = message.object();
  auto page = object ? name_of(object, "page") : std::nullopt;
  std::optional<std::vector<std::uint8_t>> levels;
  if (object) // GCC 14 warns of `levels` after a conditional expression
    levels = integers<std::uint8_t>(json::array(object, "levels"), kMostPercent);
  const auto duration = object ? json::integer(object, "duration", kLeast, kLongest) : std::nullopt;
  if (!page || !levels || !duration)
    return expected("page, levels from 0 to 100 and duration from 20 to 2000 ms");
  return FeelMessage{ .page = *std::move(page),
                      .levels = *std::move(levels),
                      .duration = static_cast<int>(*duration) };
}

std::string
write_cues(const std::vector<Cue> &cues)
{
  g_autoptr(JsonBuilder) builder = json_builder_new_immutable();
  add_cues(builder, cues);
  return written(builder);
}

std::string
write_splices(const std::vector<Splice> &splices)
{
  g_autoptr(JsonBuilder) builder = json_builder_new_immutable();
  add_splices(builder, splices);
  return written(builder);
}

} // namespace desk
