// SPDX-License-Identifier: LGPL-2.1-or-later
#include "library.h"

#include "tracks/formats/track_file.h"
#include "tracks/formats/webvtt.h"

#include <glib.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace {

namespace fs = std::filesystem;

constexpr auto &kEndings = tactile::kFilmTrackEndings;

/// Tracks that are read to see when they end.
constexpr std::size_t kMostAlike = 16;

/// The path of a film on this computer; else its name alone.
fs::path
path_of(const std::string &film)
{
  if (const std::string path = local_path(film); !path.empty())
    return path;
  // Of an address the last part, and of a title no part is a folder.
  g_autofree gchar *whole = g_uri_unescape_string(film.c_str(), "/");
  std::string name = whole != nullptr ? whole : film;
  if (film.find("://") != std::string::npos) {
    name = name.substr(0, name.find_first_of("?#"));
    name = name.substr(name.rfind('/') + 1);
  }
  for (char &c : name)
    c = c == '/' ? '_' : c;
  return name;
}

/// Names of tracks in a folder, without their endings.
std::vector<std::string>
stems(const fs::path &film)
{
  std::vector<std::string> names{ film.stem().string() };
  if (film.filename() != film.stem()) // a title may have a dot, too
    names.push_back(film.filename().string());
  return names;
}

/// Of the names of a track, subtitles have one, too.
bool
may_be_subtitles(const std::string &path)
{
  constexpr std::string_view kSubtitles = ".vtt";
  if (!path.ends_with(kSubtitles) || path.ends_with(kEndings[0]))
    return false;
  const auto file = tactile::read_track_text(path);
  return file && !tactile::is_meant_as_track(file->text);
}

std::optional<FoundTrack>
find_in(const fs::path &folder, const fs::path &film, const Library::Skipped &skipped,
        std::string &complaint)
{
  for (const std::string &stem : stems(film))
    for (const char *ending : kEndings) {
      std::string candidate = (folder / (stem + ending)).string();
      std::error_code error;
      if (stem.empty() || skipped.contains(candidate) || !fs::exists(candidate, error)
          || fs::is_directory(candidate, error))
        continue;
      const auto version = DraftCache::version(candidate);
      auto track = tactile::read_track_file(candidate);
      if (track)
        return FoundTrack{ .path = std::move(candidate), .track = *std::move(track) };
      std::string fault = std::move(track).error().text();
      if (!may_be_subtitles(candidate))
        return FoundTrack{ .path = std::move(candidate),
                           .fault = std::move(fault),
                           .version = version };
      complaint = std::move(fault);
    }
  return std::nullopt;
}

/// Letters and digits, in lower case.
std::set<std::string>
words(const std::string &name)
{
  std::set<std::string> words;
  g_autofree gchar *valid = g_utf8_make_valid(name.c_str(), -1);
  g_autofree gchar *plain = g_utf8_casefold(valid, -1);
  std::string word;
  for (const gchar *at = plain;; at = g_utf8_next_char(at)) {
    if (g_unichar_isalnum(g_utf8_get_char(at))) {
      word.append(at, static_cast<std::size_t>(g_utf8_next_char(at) - at));
    } else if (!word.empty()) {
      words.insert(std::exchange(word, {}));
    }
    if (*at == '\0')
      return words;
  }
}

/// The name of a track without its ending; empty: it is none by its name.
std::string
track_stem(const std::string &name)
{
  for (const char *ending : kEndings)
    if (name.ends_with(ending))
      return name.substr(0, name.size() - std::strlen(ending));
  return "";
}

} // namespace

std::string
local_path(const std::string &film)
{
  g_autofree gchar *path = g_filename_from_uri(film.c_str(), nullptr, nullptr);
  if (path != nullptr)
    return path;
  return film.find("://") == std::string::npos && film.starts_with('/') ? film : "";
}

std::string
film_name(const std::string &film)
{
  return film.empty() ? film : path_of(film).filename().string();
}

std::optional<FoundTrack>
Library::beside(const std::string &film, const Skipped &skipped, std::string &complaint) const
{
  const fs::path path = local_path(film);
  return path.empty() ? std::nullopt : find_in(path.parent_path(), path, skipped, complaint);
}

std::optional<FoundTrack>
Library::named(const std::string &film, const Skipped &skipped, std::string &complaint) const
{
  return folder_.empty() || film.empty() ? std::nullopt
                                         : find_in(folder_, path_of(film), skipped, complaint);
}

std::optional<FoundTrack>
Library::alike(const std::string &film, tactile::Time duration, std::string &complaint) const
{
  std::multimap<std::size_t, std::string, std::greater<>> candidates; // by the number of words
  const std::set<std::string> of_film = words(film_name(film));
  std::error_code error;
  if (!folder_.empty())
    for (fs::directory_iterator entry(folder_, error), end; !error && entry != end;
         entry.increment(error)) {
      const std::set<std::string> of_track = words(track_stem(entry->path().filename().string()));
      if (!of_track.empty() && std::ranges::includes(of_film, of_track))
        candidates.emplace(of_track.size(), entry->path().string());
    }
  std::size_t looked_at = 0;
  for (const auto &[count, path] : candidates) {
    if (looked_at++ >= kMostAlike)
      break;
    auto track = tactile::read_track_file(path);
    if (track && std::chrono::abs(track->end() - duration) <= kSameEnd)
      return FoundTrack{ .path = path, .track = *std::move(track) };
    if (!track && !may_be_subtitles(path))
      complaint = std::move(track).error().text();
  }
  return std::nullopt;
}

std::string
Library::expected(const std::string &film) const
{
  const fs::path path = path_of(film);
  const std::string name = path.stem().string() + kEndings[1];
  std::string where;
  if (path.is_absolute())
    where = "'" + (path.parent_path() / name).string() + "'";
  if (!folder_.empty())
    where += (where.empty() ? "'" : " or '") + (fs::path(folder_) / name).string() + "'";
  return where.empty() ? "a folder of tracks that has '" + name + "' (--tracks)" : where;
}
