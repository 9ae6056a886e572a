// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/json_document.h"

#include <cmath>
#include <utility>

namespace tactile {

namespace {

constexpr int kDeepest = 64; ///< nesting of arrays and objects
/// Limits on memory: the parser allocates about 100 bytes per value and a hash table per object.
constexpr std::size_t kMostContainers = 2'000'000;
constexpr std::size_t kMostValues = 8'000'000;

/// Blanks a comma after the last element, as Apple's AHAP files have it.
tl::expected<void, FormatError>
check_structure(std::string &text)
{
  bool in_string = false;
  int depth = 0;
  std::size_t containers = 0;
  std::size_t values = 0;
  std::size_t line = 1;
  std::size_t last = 0; // that is no white space
  const auto wrong = [&line](std::string reason) {
    return tl::unexpected(FormatError::at_line(line, std::move(reason)));
  };
  for (std::size_t i = 0; i < text.size(); i++) {
    const char c = text[i];
    if (c == '\n')
      line++;
    if (in_string) {
      if (c == '\\')
        i++;
      else if (c == '"')
        in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kDeepest)
        return wrong("nested more than " + std::to_string(kDeepest) + " deep");
      containers++;
    } else if (c == ']' || c == '}') {
      depth--;
      if (text[last] == ',')
        text[last] = ' ';
    } else if (c == ',') {
      values++;
    } else if (!g_ascii_isspace(c) && !g_ascii_isalnum(c)
               && std::string_view(":+-.").find(c) == std::string_view::npos) {
      return wrong("this is no JSON");
    }
    if (!g_ascii_isspace(c))
      last = i;
    if (containers > kMostContainers || values > kMostValues)
      return wrong("more than " + std::to_string(kMostContainers) + " objects or "
                   + std::to_string(kMostValues) + " values");
  }
  return {};
}

} // namespace

JsonMembers::JsonMembers(JsonNode *node, std::string path, FirstError &error)
    : path_(std::move(path)), error_(&error)
{
  if (node && JSON_NODE_HOLDS_OBJECT(node))
    object_ = json_node_get_object(node);
  else
    fail("expected an object");
}

void
JsonMembers::fail(const std::string &reason) const
{
  error_->set({ .place = path_.empty() ? "document" : path_, .reason = reason });
}

bool
JsonMembers::has(const char *name) const
{
  return object_ && json_object_has_member(object_, name);
}

bool
JsonMembers::has_object(const char *name) const
{
  return has(name) && JSON_NODE_HOLDS_OBJECT(json_object_get_member(object_, name));
}

double
JsonMembers::number(const char *name) const
{
  JsonNode *node = member(name);
  const GType type
      = node && JSON_NODE_HOLDS_VALUE(node) ? json_node_get_value_type(node) : G_TYPE_INVALID;
  const double value = type == G_TYPE_DOUBLE  ? json_node_get_double(node)
                       : type == G_TYPE_INT64 ? static_cast<double>(json_node_get_int(node))
                                              : NAN;
  if (std::isfinite(value))
    return value;
  fail(std::string("expected a number '") + name + "'");
  return 0;
}

double
JsonMembers::number(const char *name, double otherwise) const
{
  return has(name) ? number(name) : otherwise;
}

double
JsonMembers::number_or_text(const char *name) const
{
  const char *text = find_text(name);
  if (!text)
    return number(name);
  char *end = nullptr;
  const double value = g_ascii_strtod(text, &end);
  if (end != text && *end == 0 && std::isfinite(value))
    return value;
  fail(std::string("expected a number '") + name + "'");
  return 0;
}

int
JsonMembers::integer(const char *name, int least, int most) const
{
  const double value = number(name);
  if (value >= least && value <= most && value == std::floor(value))
    return static_cast<int>(value);
  fail(std::string("expected a whole number '") + name + "' from " + std::to_string(least) + " to "
       + std::to_string(most));
  return least;
}

bool
JsonMembers::flag(const char *name, bool otherwise) const
{
  JsonNode *node = member(name);
  return node && JSON_NODE_HOLDS_VALUE(node) && json_node_get_value_type(node) == G_TYPE_BOOLEAN
             ? json_node_get_boolean(node)
             : otherwise;
}

const char *
JsonMembers::find_text(const char *name) const
{
  JsonNode *node = member(name);
  return node && JSON_NODE_HOLDS_VALUE(node) && json_node_get_value_type(node) == G_TYPE_STRING
             ? json_node_get_string(node)
             : nullptr;
}

std::string
JsonMembers::text(const char *name) const
{
  const char *text = find_text(name);
  if (!text)
    fail(std::string("expected a text '") + name + "'");
  return text ? text : "";
}

JsonMembers
JsonMembers::object(const char *name) const
{
  return { member(name), path_of(name), *error_ };
}

std::string
JsonMembers::json(const char *name) const
{
  JsonNode *node = member(name);
  g_autofree char *text = node ? json_to_string(node, FALSE) : nullptr;
  return text ? text : "null";
}

std::size_t
JsonMembers::size(const char *name) const
{
  JsonArray *elements = array(name);
  return elements ? json_array_get_length(elements) : 0;
}

JsonMembers
JsonMembers::element(const char *name, std::size_t index) const
{
  JsonArray *elements = array(name);
  return { elements ? json_array_get_element(elements, static_cast<guint>(index)) : nullptr,
           path_of(name) + "[" + std::to_string(index) + "]", *error_ };
}

std::vector<std::string>
JsonMembers::names() const
{
  std::vector<std::string> names;
  if (!object_)
    return names;
  g_autoptr(GList) list = json_object_get_members(object_);
  for (const GList *each = list; each; each = each->next)
    names.emplace_back(static_cast<const char *>(each->data));
  return names;
}

void
JsonMembers::set(const char *name, const std::string &json) const
{
  if (object_)
    json_object_set_member(object_, name, json_from_string(json.c_str(), nullptr));
}

JsonNode *
JsonMembers::member(const char *name) const
{
  return object_ ? json_object_get_member(object_, name) : nullptr;
}

JsonArray *
JsonMembers::array(const char *name) const
{
  JsonNode *node = member(name);
  if (node && JSON_NODE_HOLDS_ARRAY(node))
    return json_node_get_array(node);
  fail(std::string("expected an array '") + name + "'");
  return nullptr;
}

std::string
JsonMembers::path_of(const char *name) const
{
  return path_ + (path_.empty() ? "" : ".") + name;
}

tl::expected<JsonDocument, FormatError>
JsonDocument::parse(std::string_view text)
{
  if (text.starts_with("\xEF\xBB\xBF"))
    text.remove_prefix(3);
  std::string plain(text);
  if (const auto checked = check_structure(plain); !checked)
    return tl::unexpected(checked.error());
  JsonDocument document;
  document.parser_.reset(json_parser_new());
  g_autoptr(GError) error = nullptr;
  if (!json_parser_load_from_data(document.parser_.get(), plain.data(),
                                  static_cast<gssize>(plain.size()), &error))
    return tl::unexpected(FormatError{ .place = "document", .reason = error->message });
  return document;
}

JsonMembers
JsonDocument::root(FirstError &error) const
{
  return { json_parser_get_root(parser_.get()), "", error };
}

std::string
JsonDocument::text() const
{
  g_autofree char *text = json_to_string(json_parser_get_root(parser_.get()), FALSE);
  return std::string(text) + "\n";
}

} // namespace tactile
