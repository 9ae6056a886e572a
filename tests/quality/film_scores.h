// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "judge.h"
#include "models.h"

#include <functional>
#include <string>
#include <vector>

namespace quality {

/// Creates a new model for each film.
using ModelMaker = std::function<std::unique_ptr<Model>()>;

/// Films of one kind, and the models to score.
struct FilmCase
{
  std::string film;     ///< name of the kind
  std::string pictures; ///< background, or empty
  std::function<std::unique_ptr<LabeledFilm>(std::uint64_t seed)> make;
  cv::Size size;
  int fps = 30;
  double noise = 0; ///< σ in 8-bit codes
  bool ball = true;
  double seconds = 20;
  int seeds = 2;
  std::vector<ModelMaker> models;
};

/// Scores of one model in a case.
struct FilmScores
{
  std::string model;
  Scores scores;             ///< of all films
  std::vector<Scores> films; ///< of each
};

/// Scores the models of each case on its films with seeds 1, 2, …. `threads` ≥ 1 share the cases,
/// and the result does not depend on their number. `what`: see in_parallel().
std::vector<std::vector<FilmScores>> score_films(const std::vector<FilmCase> &cases, int threads,
                                                 const char *what);

} // namespace quality
