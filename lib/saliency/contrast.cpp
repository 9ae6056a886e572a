// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/contrast.h"

#include "saliency/pyramid.h"

#include <cmath>

namespace saliency {

Contrast::Contrast(double chroma_weight)
    : chroma_weight_squared_(static_cast<float>(chroma_weight * chroma_weight))
{
}

void
Contrast::operator()(const cv::Mat &center, const cv::Mat &surround, int octaves, cv::Mat &map)
{
  upsample(surround, octaves, octaves, center.size(), surround_);
  map.create(center.size(), CV_32FC1);
  for (int y = 0; y < map.rows; ++y) {
    const auto *c = center.ptr<cv::Vec3f>(y);
    const auto *s = surround_.ptr<cv::Vec3f>(y);
    auto *out = map.ptr<float>(y);
    for (int x = 0; x < map.cols; ++x) {
      const float dl = c[x][0] - s[x][0];
      const float da = c[x][1] - s[x][1];
      const float db = c[x][2] - s[x][2];
      out[x] = std::sqrt(dl * dl + chroma_weight_squared_ * (da * da + db * db));
    }
  }
}

} // namespace saliency
