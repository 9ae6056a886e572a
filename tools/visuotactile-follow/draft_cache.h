// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/analysis.h"
#include "library/film_content.h"
#include "tracks/track.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

/// Stores complete drafts. A film is identified by the size of its file and parts of the content,
/// not by path or name.
class DraftCache
{
public:
  /// Beyond this, the least used drafts are deleted.
  static constexpr std::uintmax_t kMostBytes = std::uintmax_t{ 256 } << 20;

  /// $XDG_CACHE_HOME/visuotactile/drafts
  static std::string usual_folder();

  explicit DraftCache(std::string folder, std::uintmax_t most_bytes = kMostBytes);

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
  void remove_old() const;

  std::string folder_;
  std::uintmax_t most_bytes_;
};
