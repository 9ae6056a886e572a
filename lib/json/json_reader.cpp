// SPDX-License-Identifier: LGPL-2.1-or-later
#include "json/json_reader.h"

namespace visuotactile::json {

namespace {

constexpr int kDeepest = 32;          ///< nesting of arrays and objects
constexpr std::size_t kLongest = 100; ///< bytes of a text
constexpr std::size_t kLongestName = 4096;

/// Rejects non-JSON that JSON-GLib accepts (comments, in which a quote would hide brackets from
/// this count), and nesting so deep that its recursive parser would overflow the stack.
bool
is_plausible(std::string_view text)
{
  bool in_string = false;
  int depth = 0;
  for (std::size_t i = 0; i < text.size(); i++) {
    const char c = text[i];
    if (c == '"')
      in_string = !in_string;
    else if (in_string && c == '\\')
      i++;
    else if (!in_string && (c == '[' || c == '{'))
      depth++;
    else if (!in_string && (c == ']' || c == '}'))
      depth--;
    else if (!in_string && !g_ascii_isspace(c) && !g_ascii_isalnum(c)
             && std::string_view(",:+-.").find(c) == std::string_view::npos)
      return false;
    if (depth > kDeepest)
      return false;
  }
  return true;
}

/// Bytes that are no UTF-8, as in names of files, are these characters while JSON-GLib has them: of
/// the last private use area, which no name has.
constexpr gunichar kBytes = 0x10fe00;
constexpr gunichar kLastByte = kBytes + 0xff;

std::string
with_bytes_as_characters(std::string_view text)
{
  std::string valid;
  const gchar *end = nullptr;
  while (!g_utf8_validate(text.data(), static_cast<gssize>(text.size()), &end)) {
    const auto length = static_cast<std::size_t>(end - text.data());
    valid += text.substr(0, length);
    gchar character[6];
    const auto byte = static_cast<guchar>(text[length]);
    valid.append(character, static_cast<std::size_t>(g_unichar_to_utf8(kBytes + byte, character)));
    text.remove_prefix(length + 1);
  }
  return valid.append(text);
}

std::string
with_bytes(const gchar *text)
{
  std::string bytes;
  for (const gchar *c = text; *c != '\0'; c = g_utf8_next_char(c)) {
    const gunichar character = g_utf8_get_char(c);
    if (character >= kBytes && character <= kLastByte)
      bytes += static_cast<char>(character - kBytes);
    else
      bytes.append(c, static_cast<std::size_t>(g_utf8_next_char(c) - c));
  }
  return bytes;
}

JsonNode *
member(JsonObject *of, const char *name)
{
  return of != nullptr ? json_object_get_member(of, name) : nullptr;
}

} // namespace

JsonParser *
parse(std::string_view text)
{
  if (!is_plausible(text) || text.find('\0') != std::string_view::npos)
    return nullptr;
  g_autoptr(JsonParser) parser = json_parser_new_immutable();
  const std::string valid = with_bytes_as_characters(text);
  if (!json_parser_load_from_data(parser, valid.data(), static_cast<gssize>(valid.size()), nullptr)
      || json_parser_get_root(parser) == nullptr)
    return nullptr;
  return static_cast<JsonParser *>(g_steal_pointer(&parser));
}

JsonObject *
object(JsonObject *of, const char *name)
{
  JsonNode *node = member(of, name);
  return node != nullptr && JSON_NODE_HOLDS_OBJECT(node) ? json_node_get_object(node) : nullptr;
}

JsonArray *
array(JsonObject *of, const char *name)
{
  JsonNode *node = member(of, name);
  return node != nullptr && JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : nullptr;
}

JsonObject *
object(JsonArray *of, guint index)
{
  JsonNode *node = json_array_get_element(of, index);
  return JSON_NODE_HOLDS_OBJECT(node) ? json_node_get_object(node) : nullptr;
}

std::optional<std::int64_t>
integer(JsonObject *of, const char *name)
{
  JsonNode *node = member(of, name);
  if (node == nullptr || !JSON_NODE_HOLDS_VALUE(node)
      || json_node_get_value_type(node) != G_TYPE_INT64)
    return std::nullopt;
  return json_node_get_int(node);
}

std::optional<std::int64_t>
integer(JsonObject *of, const char *name, std::int64_t least, std::int64_t most)
{
  const std::optional<std::int64_t> number = integer(of, name);
  return number && *number >= least && *number <= most ? number : std::nullopt;
}

std::optional<double>
number(JsonObject *of, const char *name)
{
  JsonNode *node = member(of, name);
  if (node == nullptr || !JSON_NODE_HOLDS_VALUE(node)
      || (json_node_get_value_type(node) != G_TYPE_INT64
          && json_node_get_value_type(node) != G_TYPE_DOUBLE))
    return std::nullopt;
  return json_node_get_double(node);
}

std::optional<bool>
truth(JsonObject *of, const char *name)
{
  JsonNode *node = member(of, name);
  if (node == nullptr || !JSON_NODE_HOLDS_VALUE(node)
      || json_node_get_value_type(node) != G_TYPE_BOOLEAN)
    return std::nullopt;
  return json_node_get_boolean(node) != FALSE;
}

std::string
name_of_file(JsonObject *of, const char *name)
{
  JsonNode *node = member(of, name);
  if (node == nullptr || !JSON_NODE_HOLDS_VALUE(node)
      || json_node_get_value_type(node) != G_TYPE_STRING)
    return {};
  const std::string whole = with_bytes(json_node_get_string(node));
  return whole.size() <= kLongestName ? whole : std::string();
}

std::string
whole_text(JsonObject *of, const char *name)
{
  JsonNode *node = member(of, name);
  return node && JSON_NODE_HOLDS_VALUE(node) && json_node_get_value_type(node) == G_TYPE_STRING
             ? json_node_get_string(node)
             : "";
}

std::string
text(JsonObject *of, const char *name)
{
  return text(member(of, name));
}

std::string
text(JsonNode *node)
{
  if (node == nullptr || !JSON_NODE_HOLDS_VALUE(node)
      || json_node_get_value_type(node) != G_TYPE_STRING)
    return {};
  g_autofree gchar *valid = g_utf8_make_valid(json_node_get_string(node), -1);
  std::string line;
  for (const char *c = valid; *c != '\0'; c = g_utf8_next_char(c)) {
    const std::string_view letter(c, static_cast<std::size_t>(g_utf8_next_char(c) - c));
    if (line.size() + letter.size() > kLongest)
      break;
    line += g_unichar_isprint(g_utf8_get_char(c)) ? letter : std::string_view("?");
  }
  return line;
}

ObjectText::ObjectText(std::string_view text)
    : parser_(g_utf8_validate(text.data(), static_cast<gssize>(text.size()), nullptr) ? parse(text)
                                                                                      : nullptr)
{
  JsonNode *root = parser_ ? json_parser_get_root(parser_) : nullptr;
  object_ = root && JSON_NODE_HOLDS_OBJECT(root) ? json_node_get_object(root) : nullptr;
}

ObjectText::~ObjectText()
{
  g_clear_object(&parser_);
}

std::string
write_text(const std::string &text)
{
  g_autofree gchar *valid = g_utf8_make_valid(text.data(), static_cast<gssize>(text.size()));
  g_autoptr(JsonNode) node = json_node_init_string(json_node_alloc(), valid);
  g_autofree gchar *quoted = json_to_string(node, FALSE);
  return quoted;
}

} // namespace visuotactile::json
