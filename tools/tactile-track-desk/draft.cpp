// SPDX-License-Identifier: LGPL-2.1-or-later
#include "draft.h"

#include "tracks/formats/webvtt.h"

#include <exception>
#include <utility>

FilmDraft::FilmDraft(std::string film, const AnalysisSettings &settings)
    : film_(std::move(film)), settings_(settings), cache_(DraftCache::usual_folder()),
      version_(library::file_version(film_)), track_(cache_.find(film_, settings_)),
      recorder_(settings)
{
}

void
FilmDraft::add(FilmMap map)
{
  if (full_.empty())
    if (const auto added = recorder_.add(std::move(map)); !added)
      full_ = added.error().text();
}

void
FilmDraft::end(const std::string &failure)
{
  if (track_)
    return;
  auto track = recorder_.finish();
  failure_ = !failure.empty() ? failure : track ? full_ : track.error().text();
  if (!failure_.empty())
    return;
  track_ = at_resolution(*track, tactile::kTextTick, tactile::kTextSteps); // as the next time
  try {
    cache_.keep(*track_, film_, version_, settings_);
  } catch (const std::exception &) { // it stays until the desk ends
  }
}
