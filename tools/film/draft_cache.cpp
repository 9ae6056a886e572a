// SPDX-License-Identifier: LGPL-2.1-or-later
#include "draft_cache.h"

#include "tracks/formats/track_file.h"

#include <utility>

std::string
DraftCache::usual_folder()
{
  return FilmCache::usual_folder("drafts");
}

DraftCache::DraftCache(std::string folder, std::uintmax_t most_bytes)
    : files_(std::move(folder), ".vtt", most_bytes)
{
}

std::string
DraftCache::path(const std::string &film, const AnalysisSettings &settings) const
{
  return files_.path(film, made_with(settings));
}

std::optional<tactile::Track>
DraftCache::find(const std::string &film, const AnalysisSettings &settings) const
{
  const std::string file = files_.find(film, made_with(settings));
  if (file.empty())
    return std::nullopt;
  auto track = tactile::read_track_file(file);
  return track ? std::optional(*std::move(track)) : std::nullopt;
}

void
DraftCache::keep(const tactile::Track &draft, const std::string &film,
                 const std::optional<library::FileVersion> &made_of,
                 const AnalysisSettings &settings) const
{
  files_.keep(tactile::write_track(draft, tactile::TrackFormat::webvtt, ""), film, made_of,
              made_with(settings));
}
