// SPDX-License-Identifier: LGPL-2.1-or-later
#include "film_cache.h"

#include "files/whole_file.h"
#include "translation.h"

#include <glib.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <utility>
#include <vector>

namespace fs = std::filesystem;

std::string
FilmCache::usual_folder(const char *name)
{
  g_autofree gchar *folder
      = g_build_filename(g_get_user_cache_dir(), "visuotactile", name, nullptr);
  return folder;
}

FilmCache::FilmCache(std::string folder, std::string ending, std::uintmax_t most_bytes)
    : folder_(std::move(folder)), ending_(std::move(ending)), most_bytes_(most_bytes)
{
}

std::string
FilmCache::path(const std::string &film, const std::string &made_with) const
{
  const std::string content = library::film_content(film);
  if (content.empty())
    return "";
  const std::string settled = made_with + " " + content;
  g_autofree gchar *sum
      = g_compute_checksum_for_string(G_CHECKSUM_SHA256, settled.data(), gssize(settled.size()));
  return (fs::path(folder_) / (sum + ending_)).string();
}

std::string
FilmCache::find(const std::string &film, const std::string &made_with) const
{
  std::string file = path(film, made_with);
  std::error_code error;
  if (file.empty() || !fs::is_regular_file(file, error))
    return "";
  fs::last_write_time(file, fs::file_time_type::clock::now(), error);
  return file;
}

void
FilmCache::keep(std::string_view bytes, const std::string &film,
                const std::optional<library::FileVersion> &made_of,
                const std::string &made_with) const
{
  const std::string file = path(film, made_with);
  if (file.empty())
    throw std::runtime_error(in_text("cannot read '{}'", film));
  if (library::file_version(film) != made_of)
    throw std::runtime_error(in_text("'{}' has changed since", film));
  if (g_mkdir_with_parents(folder_.c_str(), 0700) != 0)
    throw std::runtime_error(
        in_text("cannot make the folder '{}': {}", folder_, g_strerror(errno)));
  if (const auto written = files::replace_file(file, bytes, files::Readers::user); !written)
    throw std::runtime_error(in_text("cannot write {}", written.error()));
  remove_old();
}

void
FilmCache::remove_old() const
{
  struct Old
  {
    fs::file_time_type used;
    std::uintmax_t size;
    fs::path path;
  };
  std::vector<Old> all;
  std::error_code error;
  for (const auto &entry : fs::directory_iterator(folder_, error))
    if (entry.path().extension() == ending_)
      all.push_back({ .used = entry.last_write_time(error),
                      .size = entry.file_size(error),
                      .path = entry.path() });
  std::ranges::sort(all, std::ranges::greater(), &Old::used);
  std::uintmax_t bytes = 0;
  for (const Old &old : all)
    if ((bytes += old.size) > most_bytes_)
      fs::remove(old.path, error);
}
