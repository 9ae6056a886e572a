// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <libsoup/soup.h>

#include <string>
#include <string_view>

/// What answers have in common.

/// Headers that every answer has.
void add_common_headers(SoupServerMessage *message, bool inline_styles);

void answer(SoupServerMessage *message, guint status, const char *type, std::string_view body);
/// A file of a page's folder, by its name alone.
void answer_page(SoupServerMessage *message, const std::string &folder, const std::string &name);
void answer_json(SoupServerMessage *message, const std::string &json, guint status = 200);
/// {"error": text}, and other members if `more` has any, such as "\"revision\": 7".
void answer_error(SoupServerMessage *message, guint status, const std::string &text,
                  const std::string &more = "");
/// Makes a browser save it as a file.
void name_attachment(SoupServerMessage *message, const std::string &name);

/// A header of a request, or an empty text.
std::string header(SoupServerMessage *message, const char *name);
/// A value of the request's query, or an empty text.
std::string query_value(SoupServerMessage *message, const char *name);
/// A whole number from 0 on of the query; -1 if it is something else.
gint64 query_number(SoupServerMessage *message, const char *name, gint64 otherwise);
