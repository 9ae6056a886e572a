// SPDX-License-Identifier: LGPL-2.1-or-later
#include "draft_cache.h"

#include "tracks/formats/track_file.h"

#include <glib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

namespace fs = std::filesystem;

namespace {

constexpr const char *kEnding = ".vtt";

/// Of the beginning, the middle and the end.
constexpr std::uintmax_t kPart = std::uintmax_t{ 64 } << 10;

struct FreeChecksum
{
  void operator()(GChecksum *checksum) const
  {
    g_checksum_free(checksum);
  }
};

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
  std::error_code error;
  const std::uintmax_t size = fs::file_size(film, error);
  std::ifstream file(film, std::ios::binary);
  if (error || !file)
    return "";
  const std::unique_ptr<GChecksum, FreeChecksum> sum(g_checksum_new(G_CHECKSUM_SHA256));
  const std::string settled
      = made_with(settings) + " " + std::to_string(size); // of no other version's analysis
  g_checksum_update(sum.get(), reinterpret_cast<const guchar *>(settled.data()),
                    static_cast<gssize>(settled.size()));
  std::vector<char> bytes(kPart);
  for (const std::uintmax_t from :
       { std::uintmax_t{ 0 }, size / 2, size - std::min(size, kPart) }) {
    file.clear();
    file.seekg(static_cast<std::streamoff>(from));
    file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    g_checksum_update(sum.get(), reinterpret_cast<const guchar *>(bytes.data()), file.gcount());
  }
  return (fs::path(folder_) / (std::string(g_checksum_get_string(sum.get())) + kEnding)).string();
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

std::optional<DraftCache::Version>
DraftCache::version(const std::string &film)
{
  std::error_code error;
  const std::uintmax_t size = fs::file_size(film, error);
  if (error)
    return std::nullopt;
  const fs::file_time_type changed = fs::last_write_time(film, error);
  return error ? std::nullopt : std::optional(Version{ .size = size, .changed = changed });
}

void
DraftCache::keep(const tactile::Track &draft, const std::string &film,
                 const std::optional<Version> &made_of, const AnalysisSettings &settings) const
{
  const std::string file = path(film, settings);
  if (file.empty())
    throw std::runtime_error("cannot read '" + film + "'");
  if (version(film) != made_of)
    throw std::runtime_error("'" + film + "' has changed since");
  if (g_mkdir_with_parents(folder_.c_str(), 0700) != 0)
    throw std::runtime_error("cannot make the folder '" + folder_ + "': " + g_strerror(errno));
  const std::string text = tactile::write_track(draft, tactile::TrackFormat::webvtt, "");
  g_autoptr(GError) error = nullptr;
  if (!g_file_set_contents_full(file.c_str(), text.data(), static_cast<gssize>(text.size()),
                                G_FILE_SET_CONTENTS_CONSISTENT, 0600, &error))
    throw std::runtime_error("cannot write '" + file + "': " + error->message);
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
