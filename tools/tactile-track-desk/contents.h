// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "draft.h"
#include "glance.h"
#include "strip.h"

#include "film/film_part.h"

#include <memory>
#include <string>

/// Strip and draft of the desk's film. Parts that are not kept of an earlier time are made in one
/// pass over the film, in the background; a long film first has some of its key frames. Main
/// context's thread.
class FilmContents
{
public:
  /// `path`: the film's file.
  FilmContents(const Film &film, const std::string &path, const AnalysisSettings &settings);

  const Strip &strip() const
  {
    return strip_;
  }
  const FilmDraft &draft() const
  {
    return draft_;
  }

  /// Waits for the draft, with progress on a terminal. Throws std::runtime_error.
  const tactile::Track &wait_for_draft() const;

private:
  void read();
  void end(const std::string &failure);

  const Film film_;
  const AnalysisSettings settings_;
  Strip strip_;
  FilmDraft draft_;
  std::unique_ptr<Glance> glance_;
  std::unique_ptr<FilmPart> part_; ///< all of the film
};
