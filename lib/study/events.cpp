// SPDX-License-Identifier: LGPL-2.1-or-later
#include "study/events.h"

#include "json/json_reader.h"

#include <array>

namespace study {

std::int64_t
now()
{
  return g_get_real_time() / 1000;
}

std::string
date_text(std::int64_t time)
{
  g_autoptr(GDateTime) seconds = g_date_time_new_from_unix_utc(time / 1000);
  if (seconds == nullptr)
    return "";
  g_autofree gchar *text = g_date_time_format(seconds, "%Y-%m-%dT%H:%M:%S");
  std::array<char, 8> rest{};
  g_snprintf(rest.data(), rest.size(), ".%03dZ", static_cast<int>(time % 1000));
  return std::string(text) + rest.data();
}

std::string
write_number(double number)
{
  std::array<char, G_ASCII_DTOSTR_BUF_SIZE> text{};
  return g_ascii_formatd(text.data(), static_cast<gint>(text.size()), "%.10g", number);
}

Event::Event(const char *kind, std::int64_t at)
    : line_(std::string("{\"event\": \"") + kind + "\", \"at\": " + std::to_string(at))
{
}

Event &
Event::add(const char *name, const std::string &text)
{
  return add_json(name, visuotactile::json::write_text(text));
}

Event &
Event::add(const char *name, double number)
{
  return add_json(name, write_number(number));
}

Event &
Event::add(const char *name, std::int64_t number)
{
  return add_json(name, std::to_string(number));
}

Event &
Event::add_json(const char *name, const std::string &json)
{
  line_ += std::string(", \"") + name + "\": " + json;
  return *this;
}

std::string
joined(const std::vector<std::string> &words, const char *between)
{
  std::string text;
  for (const std::string &word : words)
    text += (text.empty() ? "" : between) + word;
  return text;
}

} // namespace study
