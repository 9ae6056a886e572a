// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "judge.h"
#include "models.h"

#include <functional>
#include <string>
#include <vector>

namespace quality {

/// Makes a model anew for each film.
using ModelMaker = std::function<std::unique_ptr<Model>()>;

/// Films of one kind, shown to some models.
struct FilmCase
{
  std::string film;     ///< what it is called
  std::string pictures; ///< what is behind, if anything
  std::function<std::unique_ptr<LabeledFilm>(std::uint64_t seed)> make;
  cv::Size size;
  int fps = 30;
  double noise = 0; ///< σ in 8-bit codes
  bool ball = true;
  double seconds = 20;
  int seeds = 2;
  std::vector<ModelMaker> models;
};

/// What one model made of a case.
struct FilmScores
{
  std::string model;
  Scores scores;
};

/// Shows every case's films, seeds 1, 2, …, to its models. `threads` ≥ 1 share the cases; the
/// result does not depend on their number. `progress` is called after each case, one call at a
/// time.
std::vector<std::vector<FilmScores>>
score_films(const std::vector<FilmCase> &cases, int threads,
            const std::function<void(std::size_t done)> &progress = {});

} // namespace quality
