// SPDX-License-Identifier: LGPL-2.1-or-later
#include "soup.h"

#include "files/whole_file.h"
#include "json/json_reader.h"

#include <algorithm>
#include <limits>

namespace {

constexpr const char *kPolicy
    = "default-src 'none'; script-src 'self'; img-src 'self' blob:; media-src 'self' blob:; "
      "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; "
      "style-src 'self'";
constexpr const char *kCommon[][2] = {
  { "Cache-Control", "no-store" },
  { "X-Content-Type-Options", "nosniff" },
  { "Referrer-Policy", "no-referrer" },
  { "Cross-Origin-Resource-Policy", "same-origin" },
  { "Cross-Origin-Opener-Policy", "same-origin" },
  // libsoup 3.2 keeps connections that the client has closed between requests.
  { "Connection", "close" },
};

constexpr std::size_t kLargestPage = std::size_t{ 8 } << 20;

/// The content type by the ending of a name; null: such files are not part of a page.
const char *
type_of(const std::string &name)
{
  constexpr const char *kTypes[][2] = {
    { ".html", "text/html; charset=utf-8" },
    { ".css", "text/css; charset=utf-8" },
    { ".js", "text/javascript; charset=utf-8" },
    { ".svg", "image/svg+xml" },
    { ".png", "image/png" },
    { ".txt", "text/plain; charset=utf-8" },
  };
  for (const auto &[ending, type] : kTypes)
    if (name.ends_with(ending))
      return type;
  return nullptr;
}

/// A name without folders.
bool
is_plain(const std::string &name)
{
  return !name.starts_with('.') && std::ranges::all_of(name, [](char c) {
    return g_ascii_isalnum(c) || c == '.' || c == '-' || c == '_';
  });
}

} // namespace

void
add_common_headers(SoupServerMessage *message, bool inline_styles)
{
  SoupMessageHeaders *headers = soup_server_message_get_response_headers(message);
  for (const auto &[name, value] : kCommon)
    soup_message_headers_replace(headers, name, value);
  soup_message_headers_replace(
      headers, "Content-Security-Policy",
      (std::string(kPolicy) + (inline_styles ? " 'unsafe-inline'" : "")).c_str());
}

void
answer(SoupServerMessage *message, guint status, const char *type, std::string_view body)
{
  soup_server_message_set_status(message, status, nullptr);
  soup_server_message_set_response(message, type, SOUP_MEMORY_COPY, body.data(), body.size());
}

void
answer_page(SoupServerMessage *message, const std::string &folder, const std::string &name)
{
  const char *type = type_of(name);
  if (type == nullptr || !is_plain(name))
    return answer_error(message, 404, "there is no such page");
  const auto bytes = files::read_whole(folder + "/" + name, kLargestPage);
  if (!bytes)
    return answer_error(message, 404, "there is no such page");
  answer(message, 200, type, *bytes);
}

void
answer_json(SoupServerMessage *message, const std::string &json, guint status)
{
  answer(message, status, "application/json", json);
}

void
answer_error(SoupServerMessage *message, guint status, const std::string &text,
             const std::string &more)
{
  answer_json(message,
              "{\"error\": " + visuotactile::json::write_text(text)
                  + (more.empty() ? "" : ", " + more) + "}",
              status);
}

void
name_attachment(SoupServerMessage *message, const std::string &name)
{
  g_autofree gchar *ascii = g_str_to_ascii(name.c_str(), "C");
  g_strdelimit(ascii, "\"\\\r\n", '_');
  g_autofree gchar *encoded = g_uri_escape_string(name.c_str(), nullptr, FALSE);
  soup_message_headers_replace(
      soup_server_message_get_response_headers(message), "Content-Disposition",
      (std::string("attachment; filename=\"") + ascii + "\"; filename*=UTF-8''" + encoded).c_str());
}

std::string
header(SoupServerMessage *message, const char *name)
{
  const char *value
      = soup_message_headers_get_list(soup_server_message_get_request_headers(message), name);
  return value ? value : "";
}

std::string
query_value(SoupServerMessage *message, const char *name)
{
  const char *query = g_uri_get_query(soup_server_message_get_uri(message));
  if (!query)
    return "";
  g_autoptr(GHashTable) values = soup_form_decode(query);
  const auto *value = static_cast<const char *>(g_hash_table_lookup(values, name));
  return value ? value : "";
}

gint64
query_number(SoupServerMessage *message, const char *name, gint64 otherwise)
{
  const std::string text = query_value(message, name);
  guint64 number = 0;
  if (text.empty())
    return otherwise;
  if (!g_ascii_string_to_unsigned(text.c_str(), 10, 0, std::numeric_limits<gint64>::max(), &number,
                                  nullptr))
    return -1;
  return static_cast<gint64>(number);
}
