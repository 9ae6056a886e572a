// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/mat.hpp>

#include <array>

namespace saliency {

/// An image in CIE 1976 L*a*b*: planes of L*, a* and b*, CV_32FC1 of one size.
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
  /// The planes' contents are lost unless they have that size.
  void create(cv::Size size)
  {
    for (auto &plane : planes)
      plane.create(size, CV_32FC1);
  }
};

} // namespace saliency
