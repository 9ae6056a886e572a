// SPDX-License-Identifier: LGPL-2.1-or-later
#include "chair/settings.h"

#include "chair/settings_file.h"
#include "text.h"
#include "translation.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <optional>

#include <glib.h>

namespace chair {

using visuotactile::read_number;

namespace {

constexpr Key kKeys[] = {
  { kEnabled, Kind::flag, false, N_("Whether the program's films are felt") },
  { "driver", Kind::text, false, N_("Driver, such as firmata or gamepad") },
  { "device", Kind::text, false, N_("Which board or gamepad") },
  { kGrid, Kind::grid, false, N_("Rows x columns of the tactile map") },
  { "mapping", Kind::text, false, N_("Tactor of each cell, row by row, -1 for none, as in 2,1,0") },
  { "calibration", Kind::path, false, N_("Key file of tactor-calibrate") },
  { "intensity", Kind::number, true, N_("Factor on all levels"), 0, 1 },
  { "mute", Kind::flag, true, N_("All motors at zero") },
  { kDelay, Kind::number, true, N_("Delay of all vibration in ms"), -kMostDelay, kMostDelay },
  { "sensitivity", Kind::number, true, N_("Factor on event contrast"), 0.1, 10 },
  { "density", Kind::number, true, N_("Share of the time that may be felt, 0 for any"), 0, 1 },
  { "people", Kind::choice, false, N_("Detect faces and prefer events in them"), 0, 0,
    "auto, off, fast, thorough" },
  { "sound", Kind::choice, true, N_("Profile of the sound, in programs with a soundtactile"), 0, 0,
    "off, film, music, dialogue-heavy, bass-shaker" },
};

constexpr unsigned kMostCells = 64;

bool
is_choice(const Key &key, const std::string &value)
{
  g_auto(GStrv) choices = g_strsplit(key.choices, ", ", -1);
  return g_strv_contains(choices, value.c_str());
}

std::string
text(double value)
{
  char buffer[32] = "";
  std::snprintf(buffer, sizeof buffer, "%g", value);
  std::ranges::replace(buffer, ',', '.'); // the locale's point
  return buffer;
}

bool
is_on(const Values &values)
{
  const auto found = values.find(kEnabled);
  return found != values.end() && found->second == "true";
}

/// Adds what the environment says.
void
read_environment(Values &values, std::vector<std::string> &complaints)
{
  for (const Key &key : kKeys) {
    const std::string name = variable(key);
    const char *value = g_getenv(name.c_str());
    if (value == nullptr)
      continue;
    if (takes(key, value))
      values[key.name] = value;
    else
      complaints.push_back(in_text("{}: expected {}, got '{}'", name, expected(key), value));
  }
}

} // namespace

std::span<const Key>
keys()
{
  return kKeys;
}

const Key *
find_key(std::string_view name)
{
  const auto found = std::ranges::find(kKeys, name, &Key::name);
  return found == std::end(kKeys) ? nullptr : found;
}

std::string
names_of_keys()
{
  std::string names;
  for (const Key &key : kKeys)
    names += (names.empty() ? "" : ", ") + std::string(key.name);
  return names;
}

std::string
expected(const Key &key)
{
  switch (key.kind) {
  case Kind::flag:
    return _("true or false");
  case Kind::number:
    return in_text("a number from {} to {}", text(key.least), text(key.most));
  case Kind::choice:
    return in_text("one of {}", key.choices);
  case Kind::grid:
    return in_text("rows x columns, each from 1 to {}, such as 3x3", std::to_string(kMostCells));
  case Kind::path:
    return _("an absolute path");
  case Kind::text:
    break;
  }
  return _("text of one line");
}

bool
takes(const Key &key, const std::string &value)
{
  switch (key.kind) {
  case Kind::flag:
    return value == "true" || value == "false";
  case Kind::number: {
    const std::optional<double> number = read_number<double>(value);
    return number && *number >= key.least && *number <= key.most;
  }
  case Kind::choice:
    return is_choice(key, value);
  case Kind::grid:
    return parse_grid(value).rows > 0;
  case Kind::path:
    return g_path_is_absolute(value.c_str()) && value.find('\n') == std::string::npos;
  case Kind::text:
    break;
  }
  return !value.empty() && value.find_first_of("\r\n") == std::string::npos
         && g_utf8_validate(value.c_str(), -1, nullptr);
}

std::string
variable(const Key &key)
{
  std::string name = std::string("VISUOTACTILE_") + key.name;
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::toupper(c); });
  return name;
}

Grid
parse_grid(const std::string &value)
{
  const auto cross = value.find('x');
  if (cross == std::string::npos)
    return {};
  const auto side = [](std::string_view text) {
    const std::optional<unsigned> cells = read_number<unsigned>(text);
    return cells && *cells <= kMostCells ? *cells : 0;
  };
  const Grid grid{ side(std::string_view(value).substr(0, cross)),
                   side(std::string_view(value).substr(cross + 1)) };
  return grid.rows > 0 && grid.columns > 0 ? grid : Grid{};
}

bool
Settings::enabled(bool otherwise) const
{
  return values.contains(kEnabled) ? is_on(values) : otherwise;
}

void
Settings::leave_out_shakers()
{
  const auto driver = values.find("driver");
  if (driver == values.end() || driver->second != kShakers)
    return;
  values.erase(driver);
  values.erase("device");
  for (const char *key : kOfDevice)
    values.erase(key);
  complaints.emplace_back("this program plays on no shakers (driver=audio), but on the board that "
                          "is connected; visuotactile-play plays on them");
}

std::vector<std::string>
program_names()
{
  std::vector<std::string> names;
  if (const char *name = g_get_prgname())
    names.emplace_back(name);
  g_autofree gchar *path = g_file_read_link("/proc/self/exe", nullptr);
  if (path) {
    g_autofree gchar *name = g_path_get_basename(path);
    if (names.empty() || names.front() != name)
      names.emplace_back(name);
  }
  return names;
}

Settings
read_settings()
{
  Settings settings;
  if (const auto file = SettingsFile::load()) {
    const std::vector<std::string> sections = file->sections();
    std::vector<std::string> mine = program_names();
    mine.insert(mine.begin(), kEveryProgram);
    std::ranges::reverse(mine.begin() + 1, mine.end()); // the first name has the last word
    for (const std::string &name : mine)
      if (std::ranges::find(sections, name) != sections.end())
        for (auto &[key, value] : file->values(name, settings.complaints))
          settings.values[key] = value;
    std::vector<std::string> of_others;
    // Off for all programs is off for each.
    const Values everyone = file->values(kEveryProgram, of_others);
    if (const auto mute = everyone.find("mute"); mute != everyone.end() && mute->second == "true")
      settings.values["mute"] = "true";
    for (const std::string &name : sections)
      if (std::ranges::find(mine, name) == mine.end())
        settings.others = settings.others || is_on(file->values(name, of_others));
  } else {
    settings.complaints.push_back(file.error());
  }
  read_environment(settings.values, settings.complaints);
  return settings;
}

bool
any_enabled()
{
  const Settings settings = read_settings();
  return settings.others || settings.enabled(false);
}

} // namespace chair
