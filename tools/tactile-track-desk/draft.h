// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/draft_cache.h"
#include "tracks/track.h"

#include <optional>
#include <string>

/// The automatic draft of a film, as tactile-track author makes it. It is kept among the drafts of
/// visuotactile-follow. Main context's thread, except for add().
class FilmDraft
{
public:
  /// Has the track that is kept. `film`: the film's file.
  FilmDraft(std::string film, const AnalysisSettings &settings);

  const std::optional<tactile::Track> &track() const
  {
    return track_;
  }
  /// Why there is none; empty: there is one, or there may be.
  const std::string &failure() const
  {
    return failure_;
  }

  /// The next map of the film, from the thread that reads it. Maps beyond a full track fail in
  /// end().
  void add(FilmMap map);
  /// After all maps, or with what failed.
  void end(const std::string &failure);

private:
  const std::string film_;
  const AnalysisSettings settings_;
  const DraftCache cache_;
  const std::optional<library::FileVersion> version_; ///< of the film's file
  std::optional<tactile::Track> track_;
  TrackRecorder recorder_;
  std::string full_; ///< why maps were not added
  std::string failure_;
};
