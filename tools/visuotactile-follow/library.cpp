// SPDX-License-Identifier: LGPL-2.1-or-later
#include "library.h"

#include "tracks/formats/track_file.h"

#include <glib.h>

#include <array>
#include <filesystem>
#include <utility>
#include <vector>

namespace {

namespace fs = std::filesystem;

/// In this order.
constexpr std::array kEndings = { ".tactile.vtt", ".vtt", ".csv", ".hjif", ".sem.xml" };

/// The path of a film on this computer; else its name alone.
fs::path
path_of(const std::string &film)
{
  g_autofree gchar *path = g_filename_from_uri(film.c_str(), nullptr, nullptr);
  if (path != nullptr)
    return path;
  if (film.find("://") == std::string::npos && film.front() == '/')
    return film;
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

} // namespace

std::string
film_name(const std::string &film)
{
  return film.empty() ? film : path_of(film).filename().string();
}

std::optional<FoundTrack>
Library::find(const std::string &film, std::string &complaint) const
{
  complaint.clear();
  if (film.empty())
    return std::nullopt;
  const fs::path path = path_of(film);
  std::vector<fs::path> folders;
  if (path.is_absolute())
    folders.push_back(path.parent_path());
  if (!folder_.empty())
    folders.emplace_back(folder_);
  for (const fs::path &folder : folders)
    for (const std::string &stem : stems(path))
      for (const char *ending : kEndings) {
        std::string candidate = (folder / (stem + ending)).string();
        std::error_code error;
        if (stem.empty() || !fs::is_regular_file(candidate, error))
          continue;
        auto track = tactile::read_track_file(candidate);
        if (track)
          return FoundTrack{ std::move(candidate), *std::move(track) };
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
