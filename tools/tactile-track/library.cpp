// SPDX-License-Identifier: LGPL-2.1-or-later
//
// find and index: tracks of films in a folder or on a web server.
#include "commands.h"

#include "files/regular_file.h"
#include "film/film.h"
#include "library/heard.h"
#include "library/library.h"
#include "library/track_index.h"
#include "tracks/formats/track_file.h"
#include "translation.h"

#include <gio/gio.h>
#include <gst/gst.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>

namespace fs = std::filesystem;

namespace {

/// A film's duration; none: it cannot be decoded here, which does not matter to other searches.
std::optional<tactile::Time>
duration_of(const std::string &film)
{
  try {
    const GstClockTime duration = discover_film(film).duration;
    if (GST_CLOCK_TIME_IS_VALID(duration))
      return tactile::Time(static_cast<tactile::Time::rep>(duration));
  } catch (const std::runtime_error &) {
  }
  return std::nullopt;
}

/// Whether a name may be one of a film, and not of its poster, subtitles or entry.
bool
may_be_film(const std::string &name)
{
  if (name.ends_with(listen::kEntryEnding) || name.ends_with(".json"))
    return false;
  g_autofree gchar *type = g_content_type_guess(name.c_str(), nullptr, 0, nullptr);
  g_autofree gchar *mime = g_content_type_get_mime_type(type);
  const std::string_view found = mime != nullptr ? mime : "";
  return !found.starts_with("text/") && !found.starts_with("image/")
         && found != "application/x-subrip";
}

/// Films of a folder, by their names without extension.
std::map<std::string, fs::path>
films_in(const fs::path &folder)
{
  std::map<std::string, fs::path> films;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    std::error_code none;
    if (library::track_stem(name).empty() && may_be_film(name) && entry->is_regular_file(none))
      films.emplace(entry->path().stem().string(), entry->path());
  }
  if (error)
    throw std::runtime_error(
        in_text("cannot read the folder '{}': {}", folder.string(), error.message()));
  return films;
}

} // namespace

int
find(int argc, char **argv)
{
  TextOption output;
  TextOption tracks;
  CommonOptions common;
  const GOptionEntry entries[] = {
    { "tracks", 't', 0, G_OPTION_ARG_FILENAME, &tracks.value,
      N_("Folder of tracks, or its address on a web server (http://HOST/FOLDER)"), "DIR|URL" },
    { "output", 'o', 0, G_OPTION_ARG_FILENAME, &output.value,
      N_("Write the track to this file, or replace it; its name selects the format"), "TRACK" },
    {},
  };
  const std::vector<std::string> names = parse_options(
      argc, argv, entries, common,
      { .arguments = "FILM",
        .summary = N_("Finds the track of a film beside the film or in a library: by the film's "
                      "name, by its\ncontent, or by its duration and words of its name. Prints the "
                      "track's place; the exit\nstatus is 1 if there is none. The only requests to "
                      "a server are for its index and the\ntrack."),
        .least = 1,
        .most = 1 });
  gst_init(nullptr, nullptr);
  if (output.is_set())
    or_throw(tactile::written_format(output.text()));
  const std::string film = fs::absolute(film_path(names[0])).lexically_normal().string();
  const library::Library library(tracks.text());
  library::Library::Complaints complaints;
  auto found = library.beside(film, {}, complaints.library);
  if (!found)
    found = library.stored(film, duration_of(film), {}, complaints);
  if (found && !found->fault.empty())
    throw std::runtime_error(in_text("the track is faulty: {}", found->fault));
  if (!found) {
    const std::string why = complaints.library.empty() ? complaints.alike : complaints.library;
    throw std::runtime_error(in_text("no track for '{}': {}; make one with tactile-track author",
                                     names[0],
                                     (why.empty() ? "expected " + library.expected(film) : why)));
  }
  if (output.is_set())
    write_track_file(found->track, output.text());
  std::printf("%s\n", found->path.c_str());
  return 0;
}

int
make_index(int argc, char **argv)
{
  TextOption films;
  CommonOptions common;
  const GOptionEntry entries[] = {
    { "films", 0, 0, G_OPTION_ARG_FILENAME, &films.value,
      N_("Folder of the tracks' films, which are listed by name and content (default: FOLDER)"),
      "DIR" },
    {},
  };
  const std::vector<std::string> names = parse_options(
      argc, argv, entries, common,
      { .arguments = "FOLDER",
        .summary
        = N_("Writes FOLDER/tracks.json, in which 'tactile-track find' and visuotactile-follow "
             "search,\nalso on a web server. The films are not needed later."),
        .least = 1,
        .most = 1 });
  const fs::path folder = names[0];
  const std::map<std::string, fs::path> known = films_in(films.text(names[0].c_str()));
  std::vector<library::IndexEntry> index;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    const std::string stem = library::track_stem(name);
    if (stem.empty() || name.starts_with('.'))
      continue;
    const auto track = tactile::read_track_file(entry->path().string());
    if (!track) {
      print_error("tactile-track index", in_text("not listed: {}", track.error().text()));
      continue;
    }
    library::IndexEntry listed{ .file = name, .duration = track->end() };
    if (const auto film = known.find(stem); film != known.end()) {
      listed.film = film->second.filename().string();
      listed.content = library::film_content(film->second.string());
    }
    const std::string heard = stem + listen::kEntryEnding;
    if (const auto bytes = files::read((folder / heard).string(), listen::kMostEntry)) {
      listed.heard = heard;
      listed.heard_sum = library::content_sum(*bytes);
    }
    index.push_back(std::move(listed));
  }
  if (error)
    throw std::runtime_error(
        in_text("cannot read the folder '{}': {}", folder.string(), error.message()));
  std::ranges::sort(index, {}, &library::IndexEntry::file);
  const std::string text = library::write_index(index);
  if (const auto read = library::read_index(text); !read)
    throw std::runtime_error("'" + folder.string() + "': " + read.error());
  write_bytes(text, (folder / library::kIndexName).string());
  if (!common.quiet)
    std::printf(_("%zu tracks\n"), index.size());
  return 0;
}
