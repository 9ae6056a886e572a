// SPDX-License-Identifier: LGPL-2.1-or-later
//
// visuotactile-follow: the chair follows a film that another program plays.
#include "follower.h"

#include "film/chair_options.h"
#include "film/known_driver.h"
#include "film/live_settings.h"
#include "film/sound.h"
#include "translation.h"

#include <gst/gst.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>

namespace {

constexpr const char *kProgram = "visuotactile-follow";
constexpr gdouble kNotSet = std::numeric_limits<gdouble>::max();

struct Options
{
  TextOption mpv{};
  TextOption mpris{};
  TextOption kodi{};
  TextOption server{};
  TextOption tracks{};
  std::optional<std::string> listen{};
  gdouble listen_latency = 0; ///< ms
  TextOption sound{};
  TextOption sync_to{};
  gdouble screen_latency = kNotSet; ///< ms
  gdouble sound_latency = kNotSet;  ///< ms
  gdouble nudge = 0;                ///< ms; 0: none
  gdouble nudge_film = 0;           ///< ms; 0: none
  gboolean no_drafts = FALSE;
  gboolean once = FALSE;
  gboolean list = FALSE;
  gboolean status = FALSE;
  gboolean pass_over = FALSE;
  gboolean version = FALSE;
  ChairOptions chair;
  CommonOptions common;
};

void
expect_ms(const char *option, gdouble value)
{
  if (value != kNotSet)
    expect_range(option, value, -PlayerTiming::kMost, PlayerTiming::kMost);
}

constexpr std::string_view kServers[] = { "jellyfin", "emby", "plex" };

std::optional<follow::ServerKind>
server_of(const std::string &name)
{
  const auto *found = std::ranges::find(follow::kServerKinds, name, follow::name_of);
  return found != std::end(follow::kServerKinds) ? std::optional(*found) : std::nullopt;
}

gboolean
set_listen(const gchar *, const gchar *value, gpointer options, GError **)
{
  static_cast<Options *>(options)->listen = value != nullptr ? value : "";
  return TRUE;
}

void
read_command_line(int argc, char **argv, Options &options)
{
  const GOptionEntry entries[] = {
    { "mpv", 0, 0, G_OPTION_ARG_FILENAME, &options.mpv.value,
      N_("Follow mpv at the socket of its --input-ipc-server (default: mpv.sock in "
         "$XDG_RUNTIME_DIR)"),
      "SOCKET" },
    { "mpris", 0, 0, G_OPTION_ARG_STRING, &options.mpris.value,
      N_("Follow this player on the session bus, a name that --list-players prints"), "NAME" },
    { "kodi", 0, 0, G_OPTION_ARG_STRING, &options.kodi.value,
      N_("Follow Kodi through JSON-RPC on this host (default port: 9090)"), "HOST[:PORT]" },
    { "server", 0, 0, G_OPTION_ARG_STRING, &options.server.value,
      N_("Follow a session of this media server, whose address and token are in follow.conf"),
      "jellyfin|emby|plex" },
    { "tracks", 't', 0, G_OPTION_ARG_FILENAME, &options.tracks.value,
      N_("Folder of tracks, or its address on a web server, for films without a track beside them"),
      "DIR|URL" },
    { "listen", 0, G_OPTION_FLAG_OPTIONAL_ARG, G_OPTION_ARG_CALLBACK,
      reinterpret_cast<gpointer>(set_listen),
      N_("Recognize films of the library of --tracks by their sound, from the microphone "
         "(default), 'monitor' (the sound of this computer), a source of PulseAudio or PipeWire, "
         "or a file"),
      "SOURCE" },
    { "listen-latency", 0, 0, G_OPTION_ARG_DOUBLE, &options.listen_latency,
      N_("Time from a sound at the screen until this computer receives it, in ms, -5000 to 5000 "
         "(default: 0)"),
      "MS" },
    { "once", 0, 0, G_OPTION_ARG_NONE, &options.once, N_("Exit when the player exits"), nullptr },
    { "no-drafts", 0, 0, G_OPTION_ARG_NONE, &options.no_drafts,
      N_("Make no drafts for films without a track"), nullptr },
    { "sound", 0, 0, G_OPTION_ARG_STRING, &options.sound.value, kSoundHelp, "PROFILE" },
    { "sync-to", 0, 0, G_OPTION_ARG_STRING, &options.sync_to.value,
      N_("Synchronize the chair with the screen or the sound (default: screen)"), "screen|sound" },
    { "screen-latency", 0, 0, G_OPTION_ARG_DOUBLE, &options.screen_latency,
      N_("Time until a picture of the player is visible, in ms, -5000 to 5000 (default: 0)"),
      "MS" },
    { "sound-latency", 0, 0, G_OPTION_ARG_DOUBLE, &options.sound_latency,
      N_("Time until a sound of the player is audible, in ms, -5000 to 5000 (default: measured "
         "with each player)"),
      "MS" },
    { "status", 's', 0, G_OPTION_ARG_NONE, &options.status,
      N_("Print the state of the running visuotactile-follow, and exit"), nullptr },
    { "nudge", 'n', 0, G_OPTION_ARG_DOUBLE, &options.nudge,
      N_("Delay the vibration of the running visuotactile-follow, in ms (negative: advance it), "
         "store the sum for this kind of player, and exit"),
      "MS" },
    { "nudge-film", 0, 0, G_OPTION_ARG_DOUBLE, &options.nudge_film,
      N_("As --nudge, but store the sum for the film that plays, in any player"), "MS" },
    { "pass-over", 'p', 0, G_OPTION_ARG_NONE, &options.pass_over,
      N_("Make the running visuotactile-follow skip the film's faulty track until its file "
         "changes, in favor of another track or a draft, and exit"),
      nullptr },
    { "list-players", 'l', 0, G_OPTION_ARG_NONE, &options.list,
      N_("Print the running players, and exit"), nullptr },
    { "version", 0, 0, G_OPTION_ARG_NONE, &options.version, N_("Print the version and exit"),
      nullptr },
    {},
  };
  UserDefaults defaults(kProgram);
  options.chair.fill(defaults);
  defaults.fill("sound", options.sound);
  const auto chair = options.chair.entries();
  parse_options(
      argc, argv, entries, options.common,
      { .arguments = "",
        .summary
        = N_("Plays the track of a film on the chair, in sync with the film in another\nprogram: "
             "mpv, Kodi, VLC, a browser and other players that report their\nposition through "
             "mpv's socket, Kodi's JSON-RPC or MPRIS on the session bus,\nand players of Jellyfin, "
             "Emby and Plex through their server. Without --mpv,\n--kodi, --mpris and --server, "
             "the program follows any player that plays.\n\nThe track of FILM.mkv is FILM.vtt (or "
             ".tactile.vtt, .csv, .hjif, .sem.xml,\n.haptic, .ahap, .funscript, .tact) beside it, "
             "a track in the film, or one of\nthe library of --tracks; tactile-track makes tracks. "
             "For other films on this\ncomputer, the program makes a draft while they "
             "play.\n\nCtrl-C stops the program and all motors. SIGUSR1 delays the vibration "
             "by\n10 ms, SIGUSR2 advances it by 10 ms."),
        .least = 0,
        .most = 0,
        .quiet_help = Usage::kOnlyErrors,
        .more = chair.data(),
        .callback_data = &options,
        .group = gst_init_get_option_group() });
  options.chair.check(defaults);
  expect_ms("--screen-latency", options.screen_latency);
  expect_ms("--sound-latency", options.sound_latency);
  expect_ms("--nudge", options.nudge);
  expect_ms("--nudge-film", options.nudge_film);
  expect_ms("--listen-latency", options.listen_latency);
  if (options.listen && !options.tracks.is_set())
    throw UsageError(_("--listen needs --tracks, with the folder or address of entries of films "
                       "(tactile-track learn)"));
  constexpr std::string_view kSyncs[] = { "screen", "sound" };
  expect_one_of("--sync-to", options.sync_to.text("screen"), kSyncs);
  if (options.server.is_set())
    expect_one_of("--server", options.server.text(), kServers);
  expect_driver(options.chair.driver.text());
  const bool plays = !options.version && !options.list && !options.status && !options.pass_over
                     && options.nudge == 0 && options.nudge_film == 0;
  if (plays && !options.common.quiet)
    defaults.print(options.chair.driver.text());
}

/// The socket in the user's own folder, where no other user can put one.
std::string
usual_socket()
{
  g_autofree gchar *path = g_build_filename(g_get_user_runtime_dir(), "mpv.sock", nullptr);
  return path;
}

/// Kodi on this computer, if the user has it; otherwise nothing is opened.
std::string
usual_kodi()
{
  g_autofree gchar *folder = g_build_filename(g_get_home_dir(), ".kodi", nullptr);
  return g_file_test(folder, G_FILE_TEST_IS_DIR) ? "localhost" : "";
}

void
print_status()
{
  const FollowStatus status = ask_status();
  const auto line = [](const char *name, const std::string &value) {
    if (!value.empty())
      std::printf("%-9s %s\n", name, value.c_str());
  };
  line("state:", status.state);
  line("player:", status.player);
  line("film:", status.film);
  line("track:", status.track);
  line("fault:", status.fault);
  if (status.position >= 0)
    std::printf("%-9s %.1f s\n", "position:", status.position);
  if (status.ahead >= 0)
    std::printf(_("%-9s %.1f s of the film are known\n"), "ahead:", status.ahead);
  if (status.player.empty())
    return;
  std::printf(_("%-9s %+.0f ms, of the %s\n"), "latency:", status.latency, status.sync_to.c_str());
  std::printf(_("%-9s %+.0f ms, with this film %+.0f ms more\n"), "offset:", status.offset,
              status.film_offset);
}

void
run(const Options &options)
{
  if (options.nudge != 0)
    std::printf(_("offset: %+.0f ms\n"), send_nudge(options.nudge, false));
  if (options.nudge_film != 0)
    std::printf(_("offset: %+.0f ms\n"), send_nudge(options.nudge_film, true));
  if (options.pass_over)
    send_pass_over();
  if (options.status)
    print_status();
  if (options.nudge != 0 || options.nudge_film != 0 || options.pass_over || options.status)
    return;
  const auto given = [](gdouble ms) {
    return ms != kNotSet ? std::optional(ms) : std::nullopt;
  };
  // A folder may come later, and an address is no file.
  std::error_code error;
  std::string tracks = options.tracks.text();
  if (std::filesystem::is_directory(tracks, error))
    tracks = std::filesystem::absolute(tracks, error).string(); // as programs read it on the bus
  else if (std::filesystem::exists(tracks, error))
    throw std::runtime_error(
        in_text("'{}' is not a folder; expected a folder or an address for --tracks", tracks));
  const bool any = !options.mpv.is_set() && !options.kodi.is_set() && !options.mpris.is_set()
                   && !options.server.is_set();
  std::optional<FilmListener::Settings> listens;
  if (options.listen && !options.list)
    listens = { .source = *options.listen,
                .library = tracks,
                .latency = follow::Time(std::llround(options.listen_latency * 1e6)) };
  Follower follower(
      { .mpv_socket = options.mpv.text(any ? usual_socket().c_str() : ""),
        .insists_on_mpv = options.mpv.is_set(),
        .kodi = options.kodi.text(any ? usual_kodi().c_str() : ""),
        .insists_on_kodi = options.kodi.is_set(),
        .server = server_of(options.server.text()),
        .uses_servers = any || options.server.is_set(),
        .listens = listens,
        .uses_bus = any || options.mpris.is_set(),
        .mpris = options.mpris.text(),
        .track = { .library = tracks,
                   .makes_drafts = options.no_drafts == FALSE,
                   .analysis = { .sound = sound_profile(options.sound.text("off")) } },
        .sink = options.chair.sink_line(),
        .sync_to = sync_of(options.sync_to.text()),
        .screen_latency = given(options.screen_latency),
        .sound_latency = given(options.sound_latency),
        .once = options.once != FALSE,
        .quiet = options.common.quiet || options.list });
  if (options.list)
    follower.list();
  else
    follower.run();
}

} // namespace

int
main(int argc, char **argv)
{
  LiveSettings::at_start();
  try {
    Options options;
    read_command_line(argc, argv, options);
    if (options.version) {
      std::printf("%s %s\n", kProgram, PACKAGE_VERSION);
      return 0;
    }
    run(options);
    return 0;
  } catch (const Help &help) {
    std::fputs(help.text.c_str(), stdout);
    return 0;
  } catch (const UsageError &error) {
    print_error(kProgram, in_text("{}; see {} --help", error.what(), kProgram));
    return 2;
  } catch (const std::exception &error) {
    print_error(kProgram, error.what());
    return 1;
  }
}
