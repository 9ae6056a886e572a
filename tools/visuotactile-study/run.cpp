// SPDX-License-Identifier: LGPL-2.1-or-later
#include "commands.h"
#include "site.h"

#include "../visuotactile-follow/session_watch.h"

#include "film/command_line.h"
#include "film/device_list.h"
#include "film/known_driver.h"
#include "film/or_throw.h"
#include "translation.h"
#include "web/browser.h"
#include "web/guard.h"
#include "web/kept_tokens.h"
#include "web/server.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>
#include <utility>
#include <vector>

namespace {

constexpr const char *kProgram = "visuotactile-study run";
constexpr int kHighestPort = 65535;

/// Throws std::runtime_error if a session could not be played.
void
expect_films(const study::Folder &folder, const study::Settings &overrides,
             const study::Settings &defaults)
{
  const study::Study &study = folder.study();
  std::vector<study::Condition> sessions = study.conditions();
  if (study.practice)
    sessions.push_back({ .levels = {}, .settings = *study.practice });
  std::set<study::Settings> all;
  for (const study::Condition &session : sessions)
    for (const study::Condition &group : study.groups()) {
      study::Settings settings = session.settings;
      settings.insert(group.settings.begin(), group.settings.end());
      settings.insert(study.settings.begin(), study.settings.end());
      settings.erase("intensity"); // as it matters not
      all.insert(std::move(settings));
    }
  for (study::Settings settings : all) {
    for (const auto &[name, value] : overrides)
      settings[name] = value;
    add_defaults(settings, defaults);
    const std::string &film = settings["film"];
    if (film.empty())
      throw std::runtime_error(
          _("study.ini: expected film=FILE in [settings] or in a level of each session"));
    const std::string path = folder.film(film);
    std::error_code error;
    if (!std::filesystem::exists(path, error))
      throw std::runtime_error(
          in_text("there is no film '{}'; put one there, or name another in study.ini", path));
    expect_playable(path, settings);
  }
}

/// The screen that films cover; none without an X server. Throws UsageError if none has the name.
std::optional<Monitor>
chosen_screen(const TextOption &name, bool is_quiet)
{
  const std::vector<Monitor> all = monitors();
  std::vector<std::string> each;
  for (const Monitor &one : all)
    each.push_back(one.name);
  const std::string names = study::joined(each, ", ");
  const auto found
      = name.is_set() ? std::ranges::find(all, name.text(), &Monitor::name) : all.begin();
  if (found == all.end() && name.is_set())
    throw UsageError(in_text("expected --screen=NAME of {}, got '{}'",
                             (names.empty() ? "an X server" : names), name.text()));
  if (found == all.end()) {
    print_error(kProgram, _("there is no X server: films have a window of their own size"));
    return {};
  }
  if (!is_quiet)
    std::fprintf(stderr, _("Films cover the screen %s, %d x %d, of: %s.\n"), found->name.c_str(),
                 found->width, found->height, names.c_str());
  return *found;
}

} // namespace

int
run_study(int argc, char **argv)
{
  CommonOptions common;
  TextOption driver;
  TextOption screen_name;
  gint port = 0;
  gboolean no_browser = FALSE;
  gboolean no_window = FALSE;
  const GOptionEntry entries[] = {
    { "driver", 'd', 0, G_OPTION_ARG_STRING, &driver.value,
      N_("Driver of tactorsink in all sessions, or audio (default: the study's, else auto)"),
      "NAME" },
    { "screen", 's', 0, G_OPTION_ARG_STRING, &screen_name.value,
      N_("Monitor of the participant, which films cover (default: the primary one)"), "NAME" },
    { "port", 0, 0, G_OPTION_ARG_INT, &port,
      N_("Port of 127.0.0.1, 0 to 65535; 0 (default): the usual one of this study, or any free "
         "one"),
      "N" },
    { "no-browser", 0, 0, G_OPTION_ARG_NONE, &no_browser,
      N_("Open no browser: only print the addresses"), nullptr },
    { "no-window", 'n', 0, G_OPTION_ARG_NONE, &no_window,
      N_("Show no film and play no sound, to try a study"), nullptr },
    {},
  };
  const std::vector<std::string> arguments = parse_options(
      argc, argv, entries, common,
      { .arguments = "FOLDER",
        .summary = N_("Serves a study on 127.0.0.1 and prints two addresses: the participant's "
                      "page, and the\npage on which the experimenter starts each participant. Each "
                      "answer is on the disk before\nthe next page; an interrupted session "
                      "continues at the same page. Films cover a whole\nscreen; Escape or Q stops "
                      "a film. Ctrl-C ends the server, with all motors at zero."),
        .least = 1,
        .most = 1 });
  expect_range("--port", port, 0, kHighestPort);
  gst_init(nullptr, nullptr);
  std::signal(SIGXFSZ, SIG_IGN); // a file that may not grow is an error, not the end
  const char *set = g_getenv("VISUOTACTILE_STUDY_PAGE");
  const std::string page = set ? set : STUDY_PAGE;
  std::error_code error;
  if (!std::filesystem::exists(page + "/index.html", error))
    throw std::runtime_error(
        in_text("there is no page in '{}'; install visuotactile completely", page));
  const auto folder = or_throw(study::Folder::open(arguments[0], study::Folder::Use::writes));
  print_damaged(kProgram, *folder);
  study::Settings overrides;
  if (driver.is_set()) {
    expect_driver(driver.text(), kAudio);
    overrides["driver"] = driver.text();
  }
  const study::Settings defaults = user_defaults(kProgram);
  expect_films(*folder, overrides, defaults);
  // The window of films is one of X11, also under XWayland.
  if (!no_window && g_getenv("DISPLAY") != nullptr) {
    g_setenv("GST_GL_WINDOW", "x11", FALSE);
    g_autoptr(GstPluginFeature) wayland
        = gst_registry_lookup_feature(gst_registry_get(), "waylandsink");
    if (wayland != nullptr)
      gst_plugin_feature_set_rank(wayland, GST_RANK_NONE);
  }
  const bool window = !no_window && can_show_films();
  if (!window && !no_window)
    print_error(kProgram, _("there is no display: films are played, but not shown"));
  std::optional<Monitor> screen;
  if (window)
    screen = chosen_screen(screen_name, common.quiet);

  // They stay: a page that is open when the program ends finds the next one at the same address,
  // and gives it the answer that it has kept.
  auto kept = kept_tokens(folder->data(".pages"), 2);
  if (!kept)
    print_error(kProgram,
                in_text("the pages have other addresses at the next start: {}; keep data of "
                        "people on a file system with permissions",
                        kept.error()));
  const std::vector<std::string> secrets
      = kept ? *std::move(kept) : std::vector{ random_token(), random_token() };
  const std::string experimenter_path = secrets[1] + "/";
  StudySite site(*folder, { .page = page,
                            .experimenter = experimenter_path,
                            .window = window,
                            .screen = screen,
                            .defaults = defaults,
                            .overrides = overrides });
  const Server server({ .port = static_cast<guint16>(port),
                        .usual = usual_port(std::filesystem::absolute(folder->path(), error)),
                        .program = kProgram,
                        .inline_styles = true,
                        .token = secrets[0] },
                      site);
  g_autoptr(GDBusConnection) bus
      = g_bus_get_sync(G_BUS_TYPE_SESSION, nullptr, nullptr); // none: the system bus is enough
  if (bus)
    g_dbus_connection_set_exit_on_close(bus, FALSE);
  const SessionWatch watch(bus, kProgram, [&](bool rests, const std::string &why) {
    if (rests)
      site.stop_film(why);
  });
  std::printf("%s\n%s%s\n", server.address().c_str(), server.address().c_str(),
              experimenter_path.c_str());
  std::fflush(stdout);
  Browser participant;
  Browser experimenter;
  if (!no_browser)
    for (const auto &[browser, path] : { std::pair{ &participant, std::string() },
                                         std::pair{ &experimenter, experimenter_path } })
      if (const std::string why = browser->open(server.address() + path); !why.empty())
        print_error(kProgram,
                    in_text("no browser could be opened: {}; open the addresses above", why));
  if (!common.quiet)
    std::fprintf(stderr, _("Ctrl-C ends the study's server; the answers are in '%s'.\n"),
                 folder->data("").c_str());
  run_until_signal();
  return 0;
}
