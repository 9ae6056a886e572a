// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "analysis.h"
#include "film_cache.h"

#include "tracks/track.h"

#include <optional>
#include <string>

/// Stores complete drafts.
class DraftCache
{
public:
  static std::string usual_folder();

  explicit DraftCache(std::string folder, std::uintmax_t most_bytes = FilmCache::kMostBytes);

  /// The draft that these settings made of the film; none: there is none that can be read.
  std::optional<tactile::Track> find(const std::string &film,
                                     const AnalysisSettings &settings) const;

  /// Throws std::runtime_error with the path, also if the film's file has changed since the draft
  /// was made.
  void keep(const tactile::Track &draft, const std::string &film,
            const std::optional<library::FileVersion> &made_of,
            const AnalysisSettings &settings) const;

  /// Path of the draft, which may not exist; empty: the film cannot be read.
  std::string path(const std::string &film, const AnalysisSettings &settings) const;

private:
  FilmCache files_;
};
