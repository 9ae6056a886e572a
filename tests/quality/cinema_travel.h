// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "camera_path.h"
#include "cinema_film.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace quality {

/// What moves by itself.
enum class Mover
{
  none,
  across,  ///< people stand, then walk across the camera's path
  heading, ///< the same, toward the camera or away
  appears, ///< things that appear and stay where they are
};

struct TravelSettings
{
  Travel travel = Travel::truck;
  Mover mover = Mover::none;
  cv::Size size{ 640, 360 };
  std::uint64_t seed = 1;
  /// Distances of the layers from where the camera begins, in meters; empty: chosen by the seed.
  std::vector<double> depths{};
};

/// A street of textured cards with gaps, parallel to the picture, at 5–6 depths, through which a
/// camera with a field of view of 53° travels. Half of the films begin at rest. Samples have the
/// area of a pixel, at any distance. `textures` are pictures of about twice the size.
///
/// Felt: something walks, or has appeared within 0.5 s, and most of it is visible. Allowed in its
/// cells: the 2.2 s that follow, as long as temporal windows last. Quiet: all the rest.
std::unique_ptr<CinemaFilm> travelling_film(const TravelSettings &settings,
                                            const std::vector<cv::Mat> &textures);

} // namespace quality
