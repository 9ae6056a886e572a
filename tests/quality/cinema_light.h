// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "cinema_film.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace quality {

/// Changes of light, and of the whole picture.
enum class Light
{
  dissolve, ///< from one picture to another within 0.5–2 s
  fade,     ///< to black or white and back, 0.5–2 s each way
  exposure, ///< linear light × 0.5 to × 2 within 0.5–2 s
  flash,    ///< 1–3 frames of linear light × 2 to × 4
  glow,     ///< the whole picture flickers as by firelight: ± 10 % (σ), 1–6 Hz
  fire,     ///< a fire that is lit at second 2: a warm region flickers, its glow on the rest
  fast_pan, ///< half a width to a whole one within 0.5–1 s, with the blur of a shutter of 180°
  zoom,     ///< × 1.3 to × 1.8 and back within 0.7–2 s
};

/// Changes come every 2–3 s, between them the picture rests. `pictures` have any size.
///
/// Quiet, but for the fire: felt in its cells for 0.5 s from when it is lit, allowed there until
/// 4 s later, then quiet although it flickers on.
std::unique_ptr<CinemaFilm> light_film(Light light, const std::vector<cv::Mat> &pictures,
                                       cv::Size size, std::uint64_t seed);

} // namespace quality
