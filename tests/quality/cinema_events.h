// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "cinema_film.h"

#include <cstdint>
#include <memory>

namespace quality {

/// What happens before a camera that shakes.
enum class ShakenEvent
{
  small_fireball, ///< grows to a radius of .08 widths within .27 s, stands, shrinks
  large_fireball, ///< to .15
  disc,           ///< of radius .08, is there at once
  walker,         ///< a figure starts to walk
};

/// Every 3 s such an event before a picture, in another place. The camera shakes by `pixels` of a
/// picture 640 wide (σ of each axis, 0.5–5 Hz).
///
/// Felt in its cells: for 1.2 s from its begin. Allowed anywhere: until 0.5 s after its end.
std::unique_ptr<CinemaFilm> shaken_film(ShakenEvent event, double pixels, const cv::Mat &picture,
                                        cv::Size size, std::uint64_t seed);

/// What lies over a film.
enum class Overlay
{
  growing_title, ///< over black, by a half in 8 s
  logo,          ///< of a channel, in a corner, over a picture that pans
  inset,         ///< a picture in picture that pans, over one that rests
};

/// Allowed anywhere: for 1 s from when it is there, at second 1. Quiet: all the rest.
std::unique_ptr<CinemaFilm> overlay_film(Overlay overlay, const cv::Mat &picture, cv::Size size,
                                         std::uint64_t seed);

} // namespace quality
