// SPDX-License-Identifier: LGPL-2.1-or-later
#include "house/switches.h"

#include "translation.h"

#include "chair/settings_file.h"
#include "film/program.h"

#include <glib.h>

#include <array>
#include <filesystem>
#include <stdexcept>

namespace {

namespace fs = std::filesystem;

constexpr const char *kUnit = "visuotactile-follow.service";

struct Player
{
  const char *name;    ///< of its section
  const char *program; ///< in $PATH
  const char *title;
};

constexpr std::array kPlayers
    = { Player{ "totem", "totem", "Videos (Totem)" }, Player{ "parole", "parole", "Parole" },
        Player{ "com.github.rafostar.Clapper", "clapper", "Clapper" },
        Player{ "WebKitWebProcess", "epiphany", "Web (Epiphany)" },
        Player{ "gst-play-1.0", "gst-play-1.0", "gst-play" } };

bool
has_program(const char *name)
{
  g_autofree gchar *path = g_find_program_in_path(name);
  return path != nullptr;
}

/// A script of this project in the folder of a player, by a link.
struct Script
{
  const char *name; ///< of its switch and of the player's program
  const char *title;
  const char *file; ///< in the folder of scripts
  fs::path link;
};

std::vector<Script>
scripts()
{
  return { { "mpv", "mpv", "mpv/visuotactile.lua",
             fs::path(g_get_user_config_dir()) / "mpv/scripts/visuotactile.lua" },
           { "kodi", "Kodi", "kodi/service.visuotactile",
             fs::path(g_get_home_dir()) / ".kodi/addons/service.visuotactile" } };
}

fs::path
source_of(const Script &script)
{
  const char *folder = g_getenv("VISUOTACTILE_PLAYERS"); // of a build that is not installed
  return fs::path(folder != nullptr ? folder : PLAYER_SCRIPTS) / script.file;
}

bool
is_ours(const Script &script)
{
  std::error_code error;
  return fs::is_symlink(script.link, error)
         && fs::read_symlink(script.link, error) == source_of(script);
}

void
link(const Script &script, bool on)
{
  std::error_code error;
  if (is_ours(script)) {
    if (!on)
      fs::remove(script.link, error);
  } else if (std::error_code none;
             fs::symlink_status(script.link, none).type() != fs::file_type::not_found) {
    throw std::runtime_error(in_text("'{}' is there, and not by this program; move it away first",
                                     script.link.string()));
  } else if (on) {
    if (!fs::exists(source_of(script), error))
      throw std::runtime_error(in_text("'{}' is missing; install the package visuotactile-tools",
                                       source_of(script).string()));
    fs::create_directories(script.link.parent_path(), error);
    if (!error)
      fs::create_symlink(source_of(script), script.link, error);
  }
  if (error)
    throw std::runtime_error(in_text("'{}' cannot be changed", script.link.string()) + ": "
                             + error.message());
}

bool
is_followed()
{
  std::error_code error;
  const auto wanted = fs::path("systemd/user/graphical-session.target.wants") / kUnit;
  return fs::exists(g_get_user_config_dir() / wanted, error)
         || fs::exists("/etc" / wanted, error); // for all users
}

void
systemctl(std::vector<std::string> verb)
{
  const std::string what = verb.back();
  verb.insert(verb.begin(), { "systemctl", "--user" });
  verb.emplace_back(kUnit);
  const ProgramEnd end = run_program(verb, "systemd", [](std::string_view) {});
  if (end.status != 0)
    throw std::runtime_error(in_text("systemctl cannot {}", what + " " + kUnit) + ": "
                             + end.complaint);
}

} // namespace

std::vector<Switch>
switches()
{
  chair::Values everyone;
  std::vector<std::string> complaints; // printed by `visuotactile-settings list`
  const auto file = chair::SettingsFile::load();
  const auto is_enabled = [&](const char *program) {
    if (!file)
      return false;
    chair::Values values = file->values(chair::kEveryProgram, complaints);
    for (const auto &[key, value] : file->values(program, complaints))
      values[key] = value;
    return chair::Settings{ .values = values }.enabled(false);
  };
  std::vector<Switch> all;
  for (const Player &player : kPlayers)
    all.push_back({ .name = player.name,
                    .title = player.title,
                    .is_there = has_program(player.program),
                    .is_on = is_enabled(player.name) });
  for (const Script &script : scripts())
    all.push_back({ .name = script.name,
                    .title = script.title,
                    .is_there = has_program(script.name),
                    .is_on = is_ours(script) });
  all.push_back({ .name = "follow",
                  .title = _("Any player that reports its position"),
                  .is_there = has_program("visuotactile-follow") && has_program("systemctl"),
                  .is_on = is_followed() });
  return all;
}

void
restart_follow()
{
  if (is_followed())
    systemctl({ "try-restart" });
}

bool
switch_outside_settings(const std::string &name, bool on)
{
  for (const Script &script : scripts())
    if (name == script.name) {
      link(script, on);
      return true;
    }
  if (name != "follow")
    return false;
  systemctl({ "--now", on ? "enable" : "disable" });
  return true;
}
