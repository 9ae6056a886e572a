// SPDX-License-Identifier: LGPL-2.1-or-later
#include "draft_cache.h"

#include "files/whole_file.h"

#include "tracks/formats/track_file.h"

#include <glib.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <utility>
#include <vector>

namespace fs = std::filesystem;

namespace {

constexpr const char *kEnding = ".vtt";

} // namespace

std::string
DraftCache::usual_folder()
{
  g_autofree gchar *folder
      = g_build_filename(g_get_user_cache_dir(), "visuotactile", "drafts", nullptr);
  return folder;
}

DraftCache::DraftCache(std::string folder, std::uintmax_t most_bytes)
    : folder_(std::move(folder)), most_bytes_(most_bytes)
{
}

std::string
DraftCache::path(const std::string &film, const AnalysisSettings &settings) const
{
  const std::string content = library::film_content(film);
  if (content.empty())
    return "";
  const std::string settled = made_with(settings) + " " + content; // of no other version's analysis
  g_autofree gchar *sum
      = g_compute_checksum_for_string(G_CHECKSUM_SHA256, settled.data(), gssize(settled.size()));
  return (fs::path(folder_) / (std::string(sum) + kEnding)).string();
}

std::optional<tactile::Track>
DraftCache::find(const std::string &film, const AnalysisSettings &settings) const
{
  const std::string file = path(film, settings);
  std::error_code error;
  if (file.empty() || !fs::is_regular_file(file, error))
    return std::nullopt;
  auto track = tactile::read_track_file(file);
  if (!track)
    return std::nullopt;
  fs::last_write_time(file, fs::file_time_type::clock::now(), error); // it is used
  return *std::move(track);
}

void
DraftCache::keep(const tactile::Track &draft, const std::string &film,
                 const std::optional<library::FileVersion> &made_of,
                 const AnalysisSettings &settings) const
{
  const std::string file = path(film, settings);
  if (file.empty())
    throw std::runtime_error("cannot read '" + film + "'");
  if (library::file_version(film) != made_of)
    throw std::runtime_error("'" + film + "' has changed since");
  if (g_mkdir_with_parents(folder_.c_str(), 0700) != 0)
    throw std::runtime_error("cannot make the folder '" + folder_ + "': " + g_strerror(errno));
  const std::string text = tactile::write_track(draft, tactile::TrackFormat::webvtt, "");
  if (const auto written = files::replace_file(file, text, files::Readers::user); !written)
    throw std::runtime_error("cannot write " + written.error());
  remove_old();
}

void
DraftCache::remove_old() const
{
  struct Draft
  {
    fs::file_time_type used;
    std::uintmax_t size;
    fs::path path;
  };
  std::vector<Draft> drafts;
  std::error_code error;
  for (const auto &entry : fs::directory_iterator(folder_, error))
    if (entry.path().extension() == kEnding)
      drafts.push_back({ .used = entry.last_write_time(error),
                         .size = entry.file_size(error),
                         .path = entry.path() });
  std::ranges::sort(drafts, std::ranges::greater(), &Draft::used);
  std::uintmax_t bytes = 0;
  for (const Draft &draft : drafts)
    if ((bytes += draft.size) > most_bytes_)
      fs::remove(draft.path, error);
}
