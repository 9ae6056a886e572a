// SPDX-License-Identifier: LGPL-2.1-or-later
#include "chair/settings.h"

#include "chair/settings_file.h"
#include "chair/settings_watch.h"

#include <fstream>
#include <future>
#include <iterator>

#include "support/check_tests.h"
#include "support/no_threads.h"
#include "support/settings_home.h"

using namespace chair;

namespace {

bool
contains(const std::string &text, const std::string &part)
{
  return text.find(part) != std::string::npos;
}

/// The only complaint about a file of this text.
std::string
complaint(const SettingsHome &home, const std::string &text)
{
  home.write(text);
  const Settings settings = read_settings();
  fail_unless(settings.complaints.size() == 1, "%zu complaints about:\n%s",
              settings.complaints.size(), text.c_str());
  return settings.complaints.front();
}

std::string
content(const std::string &path)
{
  std::ifstream file(path);
  return { std::istreambuf_iterator<char>(file), {} };
}

} // namespace

CHECK_TEST(nothing_is_set_without_a_file)
{
  const SettingsHome home;
  const Settings settings = read_settings();
  fail_unless(settings.values.empty() && settings.complaints.empty());
  fail_unless(settings.enabled(true) && !settings.enabled(false));
  fail_if(any_enabled());
}

CHECK_TEST(program_beats_all_and_environment_beats_both)
{
  const SettingsHome home;
  g_set_prgname("totem");
  home.write("[totem]\nenabled=true\nintensity=0.5\ndevice=left; \"chair\"\n"
             "[chair]\nintensity=0.25\ngrid=2x4\nmute=false\ndevice=right\n"
             "[parole]\nintensity=1\n");
  Settings settings = read_settings();
  fail_unless(settings.complaints.empty());
  fail_unless((settings.values
               == Values{ { "enabled", "true" },
                          { "intensity", "0.5" },
                          { "device", "left; \"chair\"" },
                          { "grid", "2x4" },
                          { "mute", "false" } }));
  fail_unless(settings.enabled(false) && any_enabled() && !settings.others);

  setenv("VISUOTACTILE_INTENSITY", "0.75", 1);
  setenv("VISUOTACTILE_ENABLED", "false", 1);
  settings = read_settings();
  fail_unless(settings.values["intensity"] == "0.75");
  fail_if(settings.enabled(true) || any_enabled());
}

/// Names of files are bytes: no UTF-8, and a backslash, which key files escape.
CHECK_TEST(a_path_of_any_bytes)
{
  const SettingsHome home;
  const std::string path = "/na\xefve\\motors";
  auto file = SettingsFile::load();
  fail_unless(file.has_value());
  file->set("chair", "calibration", path);
  fail_unless(file->save().has_value());
  const Settings settings = read_settings();
  fail_unless(settings.complaints.empty(), "%s", settings.complaints.front().c_str());
  fail_unless((settings.values == Values{ { "calibration", path } }));
}

CHECK_TEST(a_program_is_found_by_its_executable_too)
{
  const SettingsHome home;
  g_set_prgname("org.example.Player");
  home.write("[libs-chair_settings]\nintensity=0.5\nmute=true\n[org.example.Player]\nmute=false\n");
  const Settings settings = read_settings();
  fail_unless((settings.values == Values{ { "intensity", "0.5" }, { "mute", "false" } }));
}

CHECK_TEST(others_that_are_on_are_known)
{
  const SettingsHome home;
  g_set_prgname("totem");
  home.write("[parole]\nenabled=true\n");
  fail_unless(read_settings().others && any_enabled());
  fail_if(read_settings().enabled(false));
  home.write("[parole]\nenabled=false\n");
  fail_if(read_settings().others || any_enabled());
  home.write("[chair]\nenabled=true\n[totem]\nenabled=false\n[parole]\nenabled=yes\n");
  fail_if(any_enabled());
}

CHECK_TEST(wrong_values_are_told_and_the_others_kept)
{
  const SettingsHome home;
  const std::pair<const char *, const char *> wrong[] = {
    { "enabled=1", "[chair] enabled: expected true or false, got '1'" },
    { "intensity=1.5", "[chair] intensity: expected a number from 0 to 1, got '1.5'" },
    { "intensity=nan", "got 'nan'" },
    { "intensity=0,5", "got '0,5'" },
    { "sensitivity=0", "expected a number from 0.1 to 10, got '0'" },
    { "density=", "[chair] density: expected a number from 0 to 1, got ''" },
    { "grid=3", "[chair] grid: expected rows x columns, each from 1 to 64, such as 3x3, got '3'" },
    { "grid=0x3", "got '0x3'" },
    { "grid=3x65", "got '3x65'" },
    { "grid=3x-1", "got '3x-1'" },
    { "grid=3x3x3", "got '3x3x3'" },
    { "people=maybe", "expected one of auto, off, fast, thorough, got 'maybe'" },
    { "people=off, fast", "got 'off, fast'" },
    { "calibration=chair.conf", "expected an absolute path, got 'chair.conf'" },
    { "driver=a\\nb", "expected text of one line" },
    { "driver=\xff", "expected text of one line" },
    { "volume=1", "[chair] volume: unknown; the keys are enabled, driver, device, grid, mapping," },
  };
  for (const auto &[line, says] : wrong) {
    const std::string got = complaint(home, std::string("[chair]\nmute=true\n") + line + "\n");
    fail_unless(contains(got, says) && contains(got, home.path()), "'%s' for '%s'", got.c_str(),
                line);
    fail_unless((read_settings().values == Values{ { "mute", "true" } }));
  }
  setenv("VISUOTACTILE_DENSITY", "2", 1);
  fail_unless(complaint(home, "[chair]\ndensity=0.5\n")
              == "VISUOTACTILE_DENSITY: expected a number from 0 to 1, got '2'");
  fail_unless(read_settings().values.at("density") == "0.5");
}

CHECK_TEST(a_file_that_is_none_is_told)
{
  const SettingsHome home;
  fail_unless(contains(complaint(home, "intensity=1\n"), home.path()));
  fail_unless(contains(complaint(home, std::string(2 << 20, '\n')), "larger than the 1 MiB"));
  unlink(home.path().c_str());
  std::filesystem::create_directory(home.path());
  fail_unless(contains(read_settings().complaints.at(0), "got a folder"));
}

CHECK_TEST(what_is_written_keeps_the_rest)
{
  const SettingsHome home;
  home.write("# mine\n[chair]\n# louder\nintensity=0.5\n\n[parole]\nodd=1\n");
  auto file = *SettingsFile::load();
  file.set("totem", kEnabled, "true");
  file.set("totem", "device", " a;\"b\"\\c ");
  fail_unless(file.save().has_value());
  for (const char *kept : { "# mine\n", "[chair]\n# louder\nintensity=0.5\n", "[parole]\nodd=1\n" })
    fail_unless(contains(content(home.path()), kept), "%s", content(home.path()).c_str());

  file = *SettingsFile::load();
  std::vector<std::string> complaints;
  fail_unless((file.values("totem", complaints)
               == Values{ { "enabled", "true" }, { "device", " a;\"b\"\\c " } }));
  fail_unless(complaints.empty());
  fail_unless(file.unset("totem", kEnabled) && !file.unset("totem", kEnabled));
  fail_unless(file.unset("totem", "device"));
  fail_if(file.unset("nobody", "device"));
  fail_unless(file.save().has_value());
  const std::string after = content(home.path());
  fail_unless(contains(after, "odd=1") && !contains(after, "totem"), "%s", after.c_str());
}

CHECK_TEST(a_file_that_cannot_be_written_is_told)
{
  const SettingsHome home;
  const auto file = *SettingsFile::load("/proc/nowhere/chair.conf");
  fail_unless(contains(file.save().error(), "cannot make the folder '/proc/nowhere'"));
}

CHECK_TEST(folders_are_made)
{
  const SettingsHome home;
  auto file = *SettingsFile::load();
  file.set(kEveryProgram, "mute", "true");
  fail_unless(file.save().has_value());
  fail_unless((read_settings().values == Values{ { "mute", "true" } }));
}

CHECK_TEST(every_key_takes_what_it_says)
{
  for (const Key &key : keys()) {
    fail_unless(find_key(key.name) == &key);
    fail_if(takes(key, ""));
    fail_unless(key.kind != Kind::number
                || (key.least < key.most && contains(expected(key), "number")));
  }
  fail_unless(find_key("volume") == nullptr);
  fail_unless(variable(*find_key("density")) == "VISUOTACTILE_DENSITY");
  const Grid grid = parse_grid("2x64");
  fail_unless(grid.rows == 2 && grid.columns == 64);
}

CHECK_TEST(off_for_all_programs_is_off)
{
  const SettingsHome home;
  home.write("[chair]\nmute=true\n[libs-chair_settings]\nmute=false\n");
  fail_unless(read_settings().values.at("mute") == "true");
  home.write("[chair]\nmute=false\n[libs-chair_settings]\nmute=true\n");
  fail_unless(read_settings().values.at("mute") == "true");
}

CHECK_TEST(changes_are_heard)
{
  const SettingsHome home;
  home.write("");
  std::promise<void> replaced;
  {
    const SettingsWatch watch([&replaced, told = false]() mutable {
      if (!std::exchange(told, true))
        replaced.set_value();
    });
    home.write("[chair]\nmute=true\n");
    replaced.get_future().wait();
  }
  fail_unless(read_settings().values.contains("mute"));
}

CHECK_TEST(a_watch_ends_at_once)
{
  const SettingsHome home;
  for (int i = 0; i < 200; i++)
    const SettingsWatch watch([] { fail("nothing was changed"); });
}

CHECK_TEST(without_threads_nothing_is_watched)
{
  const SettingsHome home;
  const NoThreads none;
  const SettingsWatch watch([] { fail("nothing was changed"); });
  fail_if(watch.watches());
}

CHECK_MAIN(chair_settings)
