// SPDX-License-Identifier: LGPL-2.1-or-later
#include "commands.h"

#include "chair/settings.h"
#include "chair/settings_file.h"
#include "film/command_line.h"
#include "film/known_driver.h"
#include "house/switches.h"
#include "translation.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <string_view>
#include <utility>

namespace {

constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();

std::string
table_of_keys()
{
  std::string table = _("Keys:");
  for (const chair::Key &key : chair::keys())
    table += std::string("\n  ") + key.name + ": " + _(key.help) + "; " + chair::expected(key);
  return table;
}

chair::SettingsFile
loaded(tl::expected<chair::SettingsFile, std::string> file)
{
  if (!file)
    throw std::runtime_error(file.error());
  return std::move(*file);
}

chair::SettingsFile
load_to_change()
{
  return loaded(chair::SettingsFile::load_to_change());
}

void
save(const chair::SettingsFile &file)
{
  if (const auto saved = file.save(); !saved)
    throw std::runtime_error(saved.error());
}

const chair::Key &
key_of(const std::string &name)
{
  if (const chair::Key *key = chair::find_key(name))
    return *key;
  throw UsageError(in_text("unknown key '{}': expected one of {}", name, chair::names_of_keys()));
}

/// Of KEY=VALUE.
std::pair<std::string, std::string>
pair_of(const std::string &argument)
{
  const std::size_t equals = argument.find('=');
  if (equals == std::string::npos)
    throw UsageError(in_text("expected KEY=VALUE, got '{}'", argument));
  const std::string name = argument.substr(0, equals);
  const chair::Key &key = key_of(name);
  std::string value = argument.substr(equals + 1);
  if (!chair::takes(key, value))
    throw UsageError(in_text("{}: expected {}, got '{}'", key.name, chair::expected(key), value));
  if (std::string_view(key.name) == "driver")
    expect_driver(value, chair::kShakers);
  return { key.name, std::move(value) };
}

void
check_program(const std::string &name)
{
  if (!chair::is_program_name(name))
    throw UsageError(in_text(
        "expected a program's name without folders and brackets, such as totem, got '{}'", name));
}

GOptionEntry
program_entry(TextOption &program)
{
  return { "program",
           'p',
           0,
           G_OPTION_ARG_STRING,
           &program.value,
           N_("Only for this program, such as totem (default: for all)"),
           "NAME" };
}

std::string
section_of(const TextOption &program)
{
  if (program.is_set())
    check_program(program.text());
  return program.text(chair::kEveryProgram);
}

int
enable(int argc, char **argv, const char *value, const char *summary)
{
  CommonOptions common;
  const GOptionEntry none[] = { {} };
  std::vector<std::string> programs = parse_options(
      argc, argv, none, common,
      { .arguments = "[PROGRAM...]", .summary = summary, .least = 0, .most = kAny });
  for (const std::string &program : programs)
    check_program(program);
  if (programs.empty())
    programs.emplace_back(chair::kEveryProgram);
  const bool on = std::string_view(value) == "true";
  std::string failed;
  std::erase_if(programs, [&](const std::string &program) {
    try {
      return switch_outside_settings(program, on);
    } catch (const std::runtime_error &error) { // the others are switched all the same
      failed += (failed.empty() ? "" : "; ") + std::string(error.what());
      return true;
    }
  });
  if (!programs.empty()) {
    chair::SettingsFile file = load_to_change();
    for (const std::string &program : programs)
      file.set(program, chair::kEnabled, value);
    save(file);
  }
  if (!common.quiet && !programs.empty())
    std::printf(_("written: %s\nIt applies to players that start from now on.\n"),
                chair::settings_path().c_str());
  if (!failed.empty())
    throw std::runtime_error(failed);
  return 0;
}

} // namespace

int
list(int argc, char **argv)
{
  CommonOptions common;
  const GOptionEntry none[] = { {} };
  parse_options(
      argc, argv, none, common,
      { .arguments = "",
        .summary = N_("Prints the settings of all programs, [chair], and of single ones."),
        .least = 0,
        .most = 0,
        .quiet_help = N_("Print only what is wrong") });
  const chair::SettingsFile file = loaded(chair::SettingsFile::load());
  std::vector<std::string> complaints;
  if (!common.quiet)
    std::printf("# %s\n", chair::settings_path().c_str());
  for (const std::string &section : file.sections()) {
    const chair::Values values = file.values(section, complaints);
    if (common.quiet)
      continue;
    std::printf("[%s]\n", section.c_str());
    for (const auto &[key, value] : values)
      std::printf("%s=%s\n", key.c_str(), value.c_str());
  }
  for (const std::string &complaint : complaints)
    print_error("visuotactile-settings", complaint);
  return complaints.empty() ? 0 : 1;
}

int
use(int argc, char **argv)
{
  CommonOptions common;
  const GOptionEntry none[] = { {} };
  const std::vector<std::string> arguments = parse_options(
      argc, argv, none, common,
      { .arguments = "driver=NAME [device=ID]",
        .summary = N_("Chooses the device of all programs, as 'devices' prints it. Grid, mapping "
                      "and\ncalibration of the former one are kept for the next time."),
        .least = 1,
        .most = 2 });
  chair::Values chosen;
  for (const std::string &argument : arguments) {
    const auto [name, value] = pair_of(argument);
    if (name != "driver" && name != "device")
      throw UsageError(in_text("expected driver=NAME and maybe device=ID, got '{}'", argument));
    chosen[name] = value;
  }
  if (!chosen.contains("driver"))
    throw UsageError(_("expected driver=NAME"));
  chair::SettingsFile file = load_to_change();
  file.use(chosen["driver"], chosen["device"]);
  save(file);
  if (!common.quiet)
    std::printf(_("written: %s\n"), chair::settings_path().c_str());
  restart_follow();
  return 0;
}

int
set(int argc, char **argv)
{
  TextOption program;
  CommonOptions common;
  const GOptionEntry entries[] = { program_entry(program), {} };
  const std::string summary = std::string(_("Changes settings. intensity, mute and delay apply at "
                                            "once; in players with GStreamer,\n"
                                            "sensitivity, density and sound do, too."))
                              + "\n" + table_of_keys();
  const std::vector<std::string> arguments = parse_options(
      argc, argv, entries, common,
      { .arguments = "KEY=VALUE...", .summary = summary.c_str(), .least = 1, .most = kAny });
  const std::string section = section_of(program);
  chair::SettingsFile file = load_to_change();
  for (const std::string &argument : arguments) {
    const auto [name, value] = pair_of(argument);
    file.set(section, name, value);
  }
  save(file);
  if (!common.quiet)
    std::printf(_("written: %s\n"), chair::settings_path().c_str());
  return 0;
}

int
unset(int argc, char **argv)
{
  TextOption program;
  CommonOptions common;
  const GOptionEntry entries[] = { program_entry(program), {} };
  const std::vector<std::string> arguments = parse_options(
      argc, argv, entries, common,
      { .arguments = "KEY...",
        .summary = N_("Removes settings, so that those of all programs or the defaults apply."),
        .least = 1,
        .most = kAny });
  const std::string section = section_of(program);
  chair::SettingsFile file = load_to_change();
  bool changed = false;
  for (const std::string &argument : arguments) {
    const bool was_set = file.unset(section, key_of(argument).name);
    if (!was_set && !common.quiet)
      std::printf(_("not set: %s of [%s]\n"), argument.c_str(), section.c_str());
    changed = changed || was_set;
  }
  if (!changed)
    return 0;
  save(file);
  if (!common.quiet)
    std::printf(_("written: %s\n"), chair::settings_path().c_str());
  return 0;
}

int
switch_on(int argc, char **argv)
{
  return enable(argc, argv, "true",
                N_("Enables the chair in these programs, such as totem. Without a PROGRAM: in all\n"
                   "that play with GStreamer. mpv and kodi start visuotactile-follow by a script;\n"
                   "follow is that program as a service, which follows any player."));
}

int
switch_off(int argc, char **argv)
{
  return enable(argc, argv, "false",
                N_("Disables the chair in these programs. Without a PROGRAM: in all that are not\n"
                   "enabled by name."));
}
