// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/mat.hpp>

#include <array>

namespace saliency {

/// An image in CIE 1976 L*a*b*: planes of L*, a* and b*, CV_32FC1, all of one size.
struct LabImage
{
  std::array<cv::Mat, 3> planes;

  const cv::Mat &lightness() const
  {
    return planes[0];
  }
  cv::Size size() const
  {
    return planes[0].size();
  }
};

/// The same in fixed point: planes of (value + kOffset) · kUnits, CV_16UC1, all of one size.
struct FixedLabImage
{
  static constexpr float kUnits = 128;
  static constexpr float kOffset = 128;

  std::array<cv::Mat, 3> planes;

  cv::Size size() const
  {
    return planes[0].size();
  }
};

/// Converts rows [begin, end) of a FixedLabImage plane to float L*a*b* units. `plane`: CV_32FC1 of
/// the same size.
void to_float(const cv::Mat &fixed, int begin, int end, cv::Mat &plane);

/// Converts a whole image; allocates it.
LabImage to_float(const FixedLabImage &image);

} // namespace saliency
