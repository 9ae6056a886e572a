// SPDX-License-Identifier: LGPL-2.1-or-later
#include "film_cases.h"

#include "pictures.h"
#include "table.h"

#include <opencv2/core.hpp>

#include <algorithm>

namespace quality {

FilmCase
ball_case(tactile::FilmPattern pattern, cv::Size size, int fps, double noise)
{
  FilmCase film;
  film.film = pattern == tactile::FilmPattern::static_motion ? "static-motion" : "dynamic-motion";
  film.make = [pattern](std::uint64_t seed) {
    return ball_film({ .pattern = pattern, .seed = seed });
  };
  film.size = size;
  film.fps = fps;
  film.noise = noise;
  return film;
}

FilmCase
disturbed_case(Disturbance disturbance, const Backgrounds &backgrounds, cv::Size size, bool ball,
               double noise)
{
  FilmCase film;
  film.film = name(disturbance);
  film.pictures = backgrounds.kind;
  film.make = [=](std::uint64_t seed) {
    auto pictures = backgrounds.pictures;
    std::rotate(pictures.begin(),
                pictures.begin() + static_cast<std::ptrdiff_t>(seed % pictures.size()),
                pictures.end());
    return disturbed_film(disturbance, pictures, size, ball, seed);
  };
  film.size = size;
  film.noise = noise;
  film.ball = ball;
  return film;
}

FilmCase
entering_case(double share, cv::Size size, double contrast)
{
  FilmCase film;
  film.film = "object of " + percent(share, 0) + " comes in";
  film.pictures = contrast < 1 ? "soft leaves" : "leaves";
  film.make = [=](std::uint64_t seed) {
    cv::Mat picture = dead_leaves({ 640, 480 }, seed);
    picture.convertTo(picture, -1, contrast, 110 * (1 - contrast));
    return entering_film(picture, dead_leaves({ 640, 480 }, seed + 100), share);
  };
  film.size = size;
  film.noise = 2;
  film.ball = false;
  film.seconds = 2;
  return film;
}

} // namespace quality
