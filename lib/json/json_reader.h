// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <json-glib/json-glib.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace visuotactile::json {

/// Parses a document of a server or a player. Null if it is no JSON, or is nested so deep that
/// JSON-GLib, which is recursive, would overflow the stack.
JsonParser *parse(std::string_view text);

/// A text that is a JSON object in UTF-8.
class ObjectText
{
public:
  explicit ObjectText(std::string_view text);
  ~ObjectText();
  ObjectText(const ObjectText &) = delete;
  ObjectText &operator=(const ObjectText &) = delete;

  /// Null: it is none.
  JsonObject *object() const
  {
    return object_;
  }

private:
  JsonParser *parser_;
  JsonObject *object_;
};

/// A text in JSON, with its quotes.
std::string write_text(const std::string &text);

/// A member that is an object or an array; null if there is none, or of another type.
JsonObject *object(JsonObject *of, const char *name);
JsonArray *array(JsonObject *of, const char *name);
/// An element that is an object; null if it is of another type.
JsonObject *object(JsonArray *of, guint index);

std::optional<std::int64_t> integer(JsonObject *of, const char *name);
/// An integer from `least` to `most`; none if it is another.
std::optional<std::int64_t> integer(JsonObject *of, const char *name, std::int64_t least,
                                    std::int64_t most);

/// An integer or another finite number.
std::optional<double> number(JsonObject *of, const char *name);
std::optional<bool> truth(JsonObject *of, const char *name);

/// A path or URI as it came, in any bytes; empty if there is none or if it has over 4096 bytes.
std::string name_of_file(JsonObject *of, const char *name);

/// A text as it came, of any length; empty if there is none.
std::string whole_text(JsonObject *of, const char *name);

/// A text for messages: of one line, 100 bytes at most. Empty if there is none.
std::string text(JsonObject *of, const char *name);
std::string text(JsonNode *node);

} // namespace visuotactile::json

// Under the same name in each library.
namespace follow {
namespace json = visuotactile::json;
}
namespace tactor {
namespace json = visuotactile::json;
}
