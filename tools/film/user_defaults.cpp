// SPDX-License-Identifier: LGPL-2.1-or-later
#include "user_defaults.h"

#include "translation.h"

#include <cstdio>
#include <utility>

UserDefaults::UserDefaults(const char *program, bool plays_on_shakers) : program_(program)
{
  chair::Settings settings = chair::read_settings();
  if (!plays_on_shakers)
    settings.leave_out_shakers();
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
  g_free(std::exchange(option.value, g_strdup(value->c_str())));
  filled_.push_back({ key, *value, [&option, text = option.value] {
                       return option.value == text; // GLib's parser puts another text there
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
UserDefaults::fill_of_driver(const char *key, TextOption &option)
{
  const std::size_t before = filled_.size();
  fill(key, option);
  if (filled_.size() > before)
    filled_.back().of_driver = &option;
}

void
UserDefaults::keep_to_driver(const std::string &driver)
{
  const std::string *usual = find("driver");
  has_own_driver_ = driver == (usual ? *usual : "auto");
  for (const Filled &filled : filled_)
    if (!has_own_driver_ && filled.of_driver != nullptr && filled.holds())
      g_clear_pointer(&filled.of_driver->value, g_free);
}

void
UserDefaults::fill_grid(gint &rows, gint &columns, gint not_given)
{
  const std::string *value = find(chair::kGrid);
  if (value == nullptr || !has_own_driver_ || (rows != not_given && columns != not_given))
    return;
  const chair::Grid grid = chair::parse_grid(*value);
  if (rows == not_given)
    rows = static_cast<gint>(grid.rows);
  if (columns == not_given)
    columns = static_cast<gint>(grid.columns);
  filled_.push_back({ chair::kGrid, *value, [] {
                       return true;
                     } });
}

std::string
UserDefaults::text(const std::string &driver) const
{
  std::string why = driver == "auto" && find("driver") == nullptr ? _("default") : _("option");
  std::string applied;
  for (const Filled &filled : filled_)
    if (filled.holds()) {
      applied += (applied.empty() ? _("; settings of the user: ") : ", ") + filled.key + "="
                 + filled.value;
      if (filled.key == "driver")
        why = _("settings");
    }
  return in_text("plays on driver={} ({})", driver, why) + applied;
}

void
UserDefaults::print(const std::string &driver) const
{
  std::fprintf(stderr, "%s: %s\n", program_.c_str(), text(driver).c_str());
}
