// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/draft_cache.h"
#include "film/film.h"
#include "tracks/track.h"

#include <gio/gio.h>

#include <functional>
#include <optional>
#include <string>

/// The program that authors, and the grid.
struct DraftSettings
{
  std::string author; ///< tactile-track
  std::string film;
  int rows = 3;
  int columns = 3;
  double rate = 5;
};

/// The automatic draft of a film, authored by tactile-track in the background and stored among the
/// drafts of visuotactile-follow. Main context's thread.
class FilmDraft
{
public:
  /// `changed` is called when the draft is complete or has failed.
  FilmDraft(DraftSettings settings, std::function<void()> changed);
  ~FilmDraft();
  FilmDraft(const FilmDraft &) = delete;
  FilmDraft &operator=(const FilmDraft &) = delete;

  const std::optional<tactile::Track> &track() const
  {
    return track_;
  }
  bool has_failed() const
  {
    return failed_;
  }

private:
  void read();

  const DraftSettings settings_;
  std::function<void()> changed_;
  const DraftCache cache_;
  const std::optional<library::FileVersion> film_; ///< the film's file, as the draft has it
  std::optional<tactile::Track> track_;
  bool failed_ = false;
  GSubprocess *process_ = nullptr;
  GCancellable *cancellable_;
};

/// Authors a track and waits, with progress on the terminal. Throws std::runtime_error.
void author_now(const DraftSettings &settings, const std::string &track);
