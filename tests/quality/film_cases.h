// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film_scores.h"

#include <opencv2/core/mat.hpp>

#include <string>
#include <vector>

namespace quality {

/// Backgrounds for the disturbances, with an aspect ratio of 4 : 3.
struct Backgrounds
{
  std::string kind;
  std::vector<cv::Mat> pictures;
};

/// One of the paper's two films.
FilmCase ball_case(tactile::FilmPattern pattern, cv::Size size, int fps, double noise);

/// Pictures with a disturbance, with or without a ball. Each seed starts with another picture.
FilmCase disturbed_case(Disturbance disturbance, const Backgrounds &backgrounds, cv::Size size,
                        bool ball, double noise);

/// Dead leaves of this contrast. Others move in until they cover `share` of the frame.
FilmCase entering_case(double share, cv::Size size, double contrast);

} // namespace quality
