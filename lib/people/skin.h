// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/lab_image.h"

#include <opencv2/core/types.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace people {

/// The likeness of a color to human skin, in [0, 1]: a Gaussian of a* and b*, which vary less than
/// lightness among people. Dark colors have no reliable hue.
inline float
skin(float lightness, float a, float b)
{
  constexpr float kDarkest = 20;
  constexpr float kCorrelation = -0.4F;
  if (lightness < kDarkest)
    return 0;
  const float x = (a - 14.0F) / 12.5F;
  const float y = (b - 20.0F) / 14.0F;
  return std::exp(-0.5F * (x * x - 2 * kCorrelation * x * y + y * y)
                  / (1 - kCorrelation * kCorrelation));
}

/// The mean likeness over a part of an image; 0 for an empty one.
inline double
mean_skin(const saliency::FixedLabImage &lab, const cv::Rect &part)
{
  using saliency::FixedLabImage;
  const auto value = [&lab](std::size_t plane, int y, int x) {
    return static_cast<float>(lab.planes[plane].at<std::uint16_t>(y, x)) / FixedLabImage::kUnits
           - FixedLabImage::kOffset;
  };
  double sum = 0;
  for (int y = part.y; y < part.br().y; ++y)
    for (int x = part.x; x < part.br().x; ++x)
      sum += static_cast<double>(skin(value(0, y, x), value(1, y, x), value(2, y, x)));
  return part.empty() ? 0 : sum / part.area();
}

} // namespace people
