// SPDX-License-Identifier: LGPL-2.1-or-later
#include "user_defaults.h"

#include <cstdio>
#include <tuple>
#include <utility>

namespace {

void
replace(TextOption &option, const char *text)
{
  g_free(std::exchange(option.value, g_strdup(text)));
}

} // namespace

UserDefaults::UserDefaults(const char *program) : program_(program)
{
  chair::Settings settings = chair::read_settings();
  for (const std::string &complaint : settings.complaints)
    print_error(program, complaint);
  values_ = std::move(settings.values);
}

const std::string *
UserDefaults::find(const char *key) const
{
  const auto found = values_.find(key);
  return found == values_.end() ? nullptr : &found->second;
}

void
UserDefaults::fill(const char *key, TextOption &option)
{
  const std::string *value = find(key);
  if (value == nullptr)
    return;
  replace(option, value->c_str());
  filled_.push_back({ key, *value, [&option, value = *value] {
                       return option.text() == value;
                     } });
}

void
UserDefaults::fill(const char *key, gdouble &option)
{
  const std::string *value = find(key);
  if (value == nullptr)
    return;
  option = g_ascii_strtod(value->c_str(), nullptr);
  filled_.push_back({ key, *value, [&option, filled = option] {
                       return option == filled;
                     } });
}

void
UserDefaults::fill(const char *key, gboolean &option)
{
  const std::string *value = find(key);
  if (value == nullptr)
    return;
  option = *value == "true" ? TRUE : FALSE;
  filled_.push_back({ key, *value, [] {
                       return true;
                     } });
}

void
UserDefaults::fill_grid(gint &rows, gint &columns)
{
  const std::string *value = find(chair::kGrid);
  if (value == nullptr)
    return;
  const chair::Grid grid = chair::parse_grid(*value);
  const std::pair filled{ static_cast<gint>(grid.rows), static_cast<gint>(grid.columns) };
  const std::pair before{ std::exchange(rows, filled.first),
                          std::exchange(columns, filled.second) };
  filled_.push_back({ chair::kGrid, *value,
                      [&rows, &columns, filled] { return std::pair(rows, columns) == filled; },
                      [&rows, &columns, before] {
                        std::tie(rows, columns) = before;
                      } });
}

void
UserDefaults::fill_of_driver(const char *key, TextOption &option)
{
  const std::size_t before = filled_.size();
  fill(key, option);
  if (filled_.size() > before)
    filled_.back().undo = [&option] {
      g_clear_pointer(&option.value, g_free);
    };
}

void
UserDefaults::keep_to_driver(const std::string &driver)
{
  const std::string *usual = find("driver");
  if (driver == (usual ? *usual : "auto"))
    return;
  for (const Filled &filled : filled_)
    if (filled.undo && filled.holds())
      filled.undo();
}

void
UserDefaults::print() const
{
  std::string applied;
  for (const Filled &filled : filled_)
    if (filled.holds())
      applied += (applied.empty() ? "" : ", ") + filled.key + "=" + filled.value;
  if (!applied.empty())
    std::fprintf(stderr, "%s: settings of the user: %s\n", program_.c_str(), applied.c_str());
}
