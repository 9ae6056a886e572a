// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/format_error.h"

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <json-glib/json-glib.h>

namespace tactile {

/// An object of a document with its path, for a reader that reports the first error. A member
/// that is missing or of another type sets the error and reads as 0 or nothing. It belongs to the
/// document.
class JsonMembers
{
public:
  JsonMembers(JsonNode *node, std::string path, FirstError &error);

  void fail(const std::string &reason) const;

  bool has(const char *name) const;
  bool has_object(const char *name) const;

  double number(const char *name) const;
  double number(const char *name, double otherwise) const;
  /// A number, or a text that holds one, as bHaptics writes both.
  double number_or_text(const char *name) const;
  int integer(const char *name, int least, int most) const;
  bool flag(const char *name, bool otherwise) const;
  /// Null, without an error, if the member is missing or not a string.
  const char *find_text(const char *name) const;
  std::string text(const char *name) const;

  JsonMembers object(const char *name) const;
  /// A member as a JSON text, "null" where it is missing.
  std::string json(const char *name) const;
  std::size_t size(const char *name) const;
  JsonMembers element(const char *name, std::size_t index) const;
  std::vector<std::string> names() const;

  /// Sets a member to a value, which is a valid JSON text.
  void set(const char *name, const std::string &json) const;

private:
  JsonNode *member(const char *name) const;
  JsonArray *array(const char *name) const;
  std::string path_of(const char *name) const;

  JsonObject *object_ = nullptr; ///< null after an error
  std::string path_;
  FirstError *error_;
};

/// A parsed document. JSON-GLib parses it; what JSON-GLib accepts beyond JSON (comments,
/// assignments), nesting that would overflow its stack, and sizes that would exhaust the memory
/// are refused first.
class JsonDocument
{
public:
  static tl::expected<JsonDocument, FormatError> parse(std::string_view text);

  /// The object at the top.
  JsonMembers root(FirstError &error) const;

  /// The document, with the values that were set.
  std::string text() const;

private:
  struct Unref
  {
    void operator()(JsonParser *parser) const
    {
      g_object_unref(parser);
    }
  };
  std::unique_ptr<JsonParser, Unref> parser_;
};

} // namespace tactile
