// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame/lab_image.h"

#include "frame/unpack_kernels.h"

#include <opencv2/core.hpp>

#include <cstddef>

namespace saliency {

void
to_float(const cv::Mat &fixed, int begin, int end, cv::Mat &plane)
{
  CV_Assert(fixed.type() == CV_16UC1 && plane.type() == CV_32FC1 && plane.size() == fixed.size());
  for (int y = begin; y < end; ++y)
    kernels::to_float(fixed.ptr<Fixed>(y), fixed.cols, 1 / FixedLabImage::kUnits,
                      -FixedLabImage::kOffset, plane.ptr<float>(y));
}

LabImage
to_float(const FixedLabImage &image)
{
  LabImage lab;
  for (std::size_t c = 0; c < 3; ++c) {
    lab.planes[c].create(image.size(), CV_32FC1);
    to_float(image.planes[c], 0, image.size().height, lab.planes[c]);
  }
  return lab;
}

} // namespace saliency
