// SPDX-License-Identifier: LGPL-2.1-or-later
#include "library/library.h"

#include "files/regular_file.h"
#include "library/track_index.h"
#include "library/web.h"
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

namespace library {

namespace fs = std::filesystem;

namespace {

constexpr auto &kEndings = tactile::kFilmTrackEndings;

/// Tracks that are read to see when they end.
constexpr std::size_t kMostAlike = 16;

/// The path of a film on this computer; else its name alone.
fs::path
path_of(const std::string &film)
{
  if (const std::string path = local_path(film); !path.empty())
    return path;
  // The last part of an address names the film; no part of a title is a folder.
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

/// Subtitles, too, have one of the names of a track.
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
      const auto version = file_version(candidate);
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

/// The entry that has the film's content; null: none has.
const IndexEntry *
of_content(const std::vector<IndexEntry> &entries, const std::string &film)
{
  const std::string path = local_path(film);
  const std::string content = path.empty() ? "" : film_content(path);
  const auto entry = std::ranges::find(entries, content, &IndexEntry::content);
  return content.empty() || entry == entries.end() ? nullptr : &*entry;
}

std::optional<FoundTrack>
by_content(const std::string &folder, const std::string &film, const Library::Skipped &skipped,
           std::string &complaint)
{
  const std::string index = (fs::path(folder) / kIndexName).string();
  std::error_code error;
  if (!fs::exists(index, error))
    return std::nullopt;
  const auto entries = files::read(index, kMostIndex)
                           .map_error([](const files::Error &error) { return error.reason; })
                           .and_then([](const std::string &text) { return read_index(text); });
  if (!entries) {
    complaint = "'" + index + "': " + entries.error() + "; make it again with tactile-track index";
    return std::nullopt;
  }
  const IndexEntry *entry = of_content(*entries, film);
  std::string path = entry != nullptr ? (fs::path(folder) / entry->file).string() : "";
  if (entry == nullptr || skipped.contains(path) || !fs::exists(path, error))
    return std::nullopt;
  const auto version = file_version(path);
  auto track = tactile::read_track_file(path);
  if (track)
    return FoundTrack{ .path = std::move(path), .track = *std::move(track) };
  return FoundTrack{ .path = std::move(path),
                     .fault = std::move(track).error().text(),
                     .version = version };
}

/// The entry of a server's index that fits a film; null: none does. A track that ends after the
/// film is another's.
const IndexEntry *
fitting(const std::vector<IndexEntry> &entries, const std::string &film,
        const std::optional<tactile::Time> &duration)
{
  if (const IndexEntry *entry = of_content(entries, film))
    return entry;
  const auto ends_before = [&](const IndexEntry &entry) {
    return !duration || entry.duration <= *duration + Library::kSameEnd;
  };
  const fs::path path = path_of(film);
  for (const std::string &stem : stems(path))
    for (const IndexEntry &entry : entries)
      if (!stem.empty() && ends_before(entry)
          && (entry.film == path.filename().string()
              || track_stem(fs::path(entry.file).filename().string()) == stem))
        return &entry;
  const IndexEntry *best = nullptr;
  std::size_t most = 0;
  const std::set<std::string> of_film = words(path.filename().string());
  for (const IndexEntry &entry : entries) {
    const std::set<std::string> of_track
        = words(track_stem(fs::path(entry.file).filename().string()));
    if (duration && std::chrono::abs(entry.duration - *duration) <= Library::kSameEnd
        && of_track.size() > most && std::ranges::includes(of_film, of_track)) {
      best = &entry;
      most = of_track.size();
    }
  }
  return best;
}

} // namespace

std::string
track_stem(const std::string &name)
{
  for (const char *ending : kEndings)
    if (name.ends_with(ending))
      return name.substr(0, name.size() - std::strlen(ending));
  return "";
}

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

Library::Library(std::string where) : where_(std::move(where))
{
  if (is_on_server() && !where_.ends_with('/'))
    where_ += '/';
}

bool
Library::is_on_server() const
{
  return is_address(where_);
}

std::optional<FoundTrack>
Library::beside(const std::string &film, const Skipped &skipped, std::string &complaint) const
{
  const fs::path path = local_path(film);
  return path.empty() ? std::nullopt : find_in(path.parent_path(), path, skipped, complaint);
}

std::optional<FoundTrack>
Library::stored(const std::string &film, const std::optional<tactile::Time> &duration,
                const Skipped &skipped, Complaints &complaints, GCancellable *stop) const
{
  if (where_.empty() || film.empty())
    return std::nullopt;
  if (is_on_server())
    return on_server(film, duration, complaints, stop);
  auto found = find_in(where_, path_of(film), skipped, complaints.library);
  if (!found)
    found = by_content(where_, film, skipped, complaints.library);
  if (!found && duration)
    found = alike(film, *duration, complaints.alike);
  return found;
}

std::optional<FoundTrack>
Library::alike(const std::string &film, tactile::Time duration, std::string &complaint) const
{
  std::multimap<std::size_t, std::string, std::greater<>> candidates; // by the number of words
  const std::set<std::string> of_film = words(film_name(film));
  std::error_code error;
  for (fs::directory_iterator entry(where_, error), end; !error && entry != end;
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

std::optional<FoundTrack>
Library::on_server(const std::string &film, const std::optional<tactile::Time> &duration,
                   Complaints &complaints, GCancellable *stop) const
{
  constexpr std::size_t kMostTrack = std::size_t{ 64 } << 20;
  const auto text = fetch(where_ + kIndexName, kMostIndex, stop);
  if (!text) {
    complaints.library = text.error();
    return std::nullopt;
  }
  const auto entries = read_index(*text);
  if (!entries) {
    complaints.library = "'" + where_ + kIndexName + "': " + entries.error();
    return std::nullopt;
  }
  const IndexEntry *entry = fitting(*entries, film, duration);
  if (entry == nullptr)
    return std::nullopt;
  g_autofree gchar *escaped = g_uri_escape_string(entry->file.c_str(), "/", FALSE);
  const std::string address = where_ + escaped;
  auto body = fetch(address, kMostTrack, stop);
  if (!body) {
    complaints.library = body.error();
    return std::nullopt;
  }
  const auto track
      = tactile::track_text(*std::move(body), entry->file).and_then([](const auto &file) {
          return tactile::read_track(file.text, file.format);
        });
  if (!track) {
    complaints.library = "'" + address + "': " + track.error().text();
    return std::nullopt;
  }
  return FoundTrack{ .path = address, .track = *track };
}

std::string
Library::expected(const std::string &film) const
{
  const fs::path path = path_of(film);
  const std::string name = path.stem().string() + kEndings[1];
  std::string where;
  if (path.is_absolute())
    where = "'" + (path.parent_path() / name).string() + "'";
  if (is_on_server())
    where += (where.empty() ? "'" : " or in '") + where_ + kIndexName + "'";
  else if (!where_.empty())
    where += (where.empty() ? "'" : " or '") + (fs::path(where_) / name).string() + "'";
  return where.empty() ? "a folder of tracks that has '" + name + "' (--tracks)" : where;
}

} // namespace library
