// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "cinema_film.h"

#include <cstdint>
#include <memory>

namespace quality {

/// What moves without end and settles.
enum class Stir
{
  rain,        ///< 250 streaks at three depths
  leaves,      ///< a picture that wind distorts by 1–4 pixels of 640, 0.3–1.5 Hz, in gusts
  water,       ///< glitter of waves on the lower two thirds
  crowd,       ///< 220 heads and shoulders that sway, jump and shift
  grain,       ///< of film, σ 4, new in every frame, correlated over 2 pixels
  coarse_grain ///< σ 8
};

/// Anything is allowed for 4 s, then all is quiet.
std::unique_ptr<CinemaFilm> stirring_film(Stir stir, const cv::Mat &picture, cv::Size size,
                                          std::uint64_t seed);

} // namespace quality
