// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactile-track-desk: a track beside its film, in a browser. tactile-track runs it.
#include "options.h"
#include "routes.h"
#include "web/browser.h"
#include "web/kept_tokens.h"
#include "web/server.h"

#include "../visuotactile-follow/session_watch.h"

#include "film/known_driver.h"
#include "film/live_settings.h"
#include "film/or_throw.h"
#include "library/library.h"
#include "tracks/formats/draft_note.h"
#include "tracks/formats/track_file.h"
#include "tracks/formats/webvtt.h"
#include "translation.h"

#include <csignal>
#include <cstdio>
#include <filesystem>

namespace fs = std::filesystem;

namespace {

constexpr const char *kProgram = "tactile-track desk";

/// The track beside a film: the one that visuotactile-follow takes, too, or the name of a new one.
/// Subtitles of the same name are left alone.
std::string
track_beside(const std::string &film)
{
  std::string free;
  std::string taken;
  for (const std::string ending : tactile::kFilmTrackEndings) {
    if (!ending.ends_with(".vtt"))
      continue;
    fs::path path = film;
    path.replace_filename(path.stem().string() + ending);
    const std::string name = path.string();
    std::error_code error;
    if (!fs::exists(name, error)) {
      free = name;
      continue;
    }
    const std::string text = or_throw(tactile::read_track_text(name)).text;
    auto track = tactile::read_webvtt(text);
    if (track)
      return name;
    if (tactile::is_meant_as_track(text))
      throw std::runtime_error(std::move(track.error()).within("'" + name + "'").text());
    taken = name;
  }
  if (free.empty())
    throw std::runtime_error(in_text("'{}' is no track; name the track to edit", taken));
  return free;
}

/// Copies the track of a film from the library of --tracks. False if it has none.
bool
copy_stored(const DeskOptions &options, const Film &film, const std::string &track)
{
  library::Library::Complaints complaints;
  const auto duration = GST_CLOCK_TIME_IS_VALID(film.duration)
                            ? std::optional(tactile::Time(static_cast<gint64>(film.duration)))
                            : std::nullopt;
  const auto found = library::Library(options.tracks.text())
                         .stored(fs::absolute(options.film).lexically_normal().string(), duration,
                                 {}, complaints);
  const std::string why = found ? found->fault : complaints.library;
  if (!why.empty())
    print_error(kProgram, why);
  if (!found || !found->fault.empty())
    return false;
  if (const auto done = files::replace_file(track, tactile::write_webvtt(found->track)); !done)
    throw std::runtime_error(done.error());
  if (!options.common.quiet)
    std::fprintf(stderr, _("'%s' is a copy of '%s'\n"), track.c_str(), found->path.c_str());
  return true;
}

/// The token of a track's address, which stays valid when the desk is started again.
std::string
token_of(const std::string &track)
{
  g_autofree gchar *name = g_compute_checksum_for_string(G_CHECKSUM_SHA256, track.c_str(), -1);
  const fs::path folder = fs::path(g_get_user_state_dir()) / "visuotactile" / "desk";
  g_mkdir_with_parents(folder.c_str(), 0700);
  const auto tokens = kept_tokens((folder / name).string(), 1);
  if (tokens)
    return tokens->front();
  print_error(kProgram,
              in_text("the page's address is another one at the next start: {}", tokens.error()));
  return "";
}

struct Unref
{
  void operator()(gpointer object) const
  {
    g_object_unref(object);
  }
};

void
run(const DeskOptions &options)
{
  expect_driver(options.chair.driver.text());
  const char *set = g_getenv("VISUOTACTILE_DESK_PAGE");
  const std::string page = set ? set : DESK_PAGE;
  std::error_code error;
  if (!fs::exists(page + "/index.html", error))
    throw std::runtime_error(
        in_text("there is no page in '{}'; install visuotactile completely", page));
  if (!fs::is_regular_file(options.film, error))
    throw std::runtime_error(in_text("'{}' is no file; expected a film's", options.film));
  const Film film = discover_film(options.film);
  AnalysisSettings settings;
  std::unique_ptr<FilmContents> contents;
  const std::string track = options.track.empty() ? track_beside(options.film) : options.track;
  if (!fs::exists(track, error) && !copy_stored(options, film, track)) {
    if (!options.common.quiet)
      std::fprintf(stderr, _("There is no '%s' yet: a draft is authored\n"), track.c_str());
    const auto format = or_throw(tactile::written_format(track));
    contents = std::make_unique<FilmContents>(film, options.film, settings);
    const std::string draft = tactile::with_draft_note(
        write_track(contents->wait_for_draft(), format, ""), made_with(settings));
    if (const auto done = files::replace_file(track, draft); !done)
      throw std::runtime_error(done.error());
  }
  const std::unique_ptr<desk::Session> session = or_throw(desk::Session::open(track));
  for (const std::string &message : session->messages())
    print_error(kProgram, message);
  const desk::Document &document = session->document();
  settings.rows = document.grid().rows;
  settings.columns = document.grid().columns;
  if (document.rate() > 0)
    settings.rate = document.rate();
  if (!contents)
    contents = std::make_unique<FilmContents>(film, options.film, settings);

  Routes routes({ .film = options.film,
                  .found = film,
                  .page = page,
                  .sink = options.chair.sink_line(),
                  .driver = options.chair.driver.text(),
                  .review = options.review != FALSE },
                *session, *contents);
  const Server server({ .port = static_cast<guint16>(options.port),
                        .usual = usual_port(session->path()),
                        .program = kProgram,
                        .token = token_of(session->path()) },
                      routes);
  const std::unique_ptr<GDBusConnection, Unref> bus(
      g_bus_get_sync(G_BUS_TYPE_SESSION, nullptr, nullptr)); // none: the system bus is enough
  if (bus)
    g_dbus_connection_set_exit_on_close(bus.get(), FALSE);
  const SessionWatch watch(bus.get(), kProgram,
                           [&](bool rests, const std::string &why) { routes.rest(rests, why); });
  std::printf("%s\n", server.address().c_str());
  std::fflush(stdout);
  Browser browser;
  if (!options.no_browser)
    if (const std::string why = browser.open(server.address()); !why.empty())
      print_error(kProgram, in_text("no browser could be opened: {}; open the address above", why));
  if (!options.common.quiet)
    std::fprintf(stderr,
                 _("Ctrl-C ends the desk. Edits of '%s' that are not saved stay in its "
                   "journal.\n"),
                 track.c_str());
  run_until_signal();
}

} // namespace

int
main(int argc, char **argv)
{
  LiveSettings::at_start();
  try {
    DeskOptions options;
    UserDefaults defaults(kProgram);
    read_desk_options(argc, argv, options, defaults);
    if (!options.common.quiet)
      defaults.print(options.chair.driver.text());
    gst_init(nullptr, nullptr);
    std::signal(SIGXFSZ, SIG_IGN); // a file that may not grow is an error, not the end
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
