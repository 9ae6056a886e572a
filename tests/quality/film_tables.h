// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "clips.h"
#include "film_cases.h"
#include "summary.h"
#include "table.h"

#include <array>
#include <filesystem>
#include <string>

namespace quality {

inline constexpr std::array kDisturbances{ Disturbance::still, Disturbance::flicker,
                                           Disturbance::fade,  Disturbance::cut,
                                           Disturbance::pan,   Disturbance::pan_and_rest,
                                           Disturbance::zoom,  Disturbance::shake };

/// How much is measured.
struct Extent
{
  bool quick = false;         ///< one size and frame rate of each film
  bool full = false;          ///< peers at all sizes and rates, the oracle for whole films
  int threads = 2;            ///< films at a time
  std::filesystem::path data; ///< where osie/ lies; empty: no photographs
  std::string scene{};        ///< those scenes of cinema whose name has it in it
  ClipSet clips{};            ///< real films
};

std::string size_text(cv::Size size);

/// The paper's films for the paper's profile, ours and all peers: the worst of each size.
Section ball_section(const Extent &extent, Summary &summary);

/// Films in which nothing happens, or a ball appears, or something large comes in: the worst of all
/// sizes and frame rates.
Section phantom_section(const Extent &extent, Summary &summary);

/// The tuned profile with one choice made otherwise: the worst of the films.
Table choice_table(int threads);

} // namespace quality
