// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film_cases.h"
#include "table.h"

#include <array>
#include <filesystem>

namespace quality {

inline constexpr std::array kDisturbances{ Disturbance::still, Disturbance::flicker,
                                           Disturbance::fade,  Disturbance::cut,
                                           Disturbance::pan,   Disturbance::pan_and_rest,
                                           Disturbance::zoom,  Disturbance::shake };

/// How much is measured.
struct Extent
{
  bool quick = false;         ///< one size and frame rate of each film
  int threads = 2;            ///< films at a time
  std::filesystem::path data; ///< where osie/ lies; empty: no photographs
};

std::string size_text(cv::Size size);

/// score_films() with its progress on standard error.
std::vector<std::vector<FilmScores>> score(const std::vector<FilmCase> &cases, int threads,
                                           const char *what);

/// The paper's films for the paper's profile, ours and all peers: the worst of each size, and every
/// figure.
struct BallTables
{
  Table worst;
  Table every;
};
BallTables ball_tables(const Extent &extent);

/// Films in which nothing happens, or a ball appears, or something large comes in.
Table phantom_table(const Extent &extent);

/// The tuned profile with one choice made otherwise: the worst of the films.
Table choice_table(int threads);

} // namespace quality
