// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/events/blur.h"

#include <algorithm>
#include <cmath>

namespace saliency {

int
Blur::reach(double sigma)
{
  return static_cast<int>(std::ceil(2.5 * sigma));
}

void
Blur::operator()(cv::Mat &map, double sigma)
{
  const int reach = Blur::reach(sigma);
  if (sigma != sigma_) {
    sigma_ = sigma;
    weights_.clear();
    double sum = 0;
    for (int i = -reach; i <= reach; ++i)
      sum += std::exp(-0.5 * i * i / (sigma * sigma));
    for (int i = -reach; i <= reach; ++i)
      weights_.push_back(static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma)) / sum));
  }
  along_rows_.create(map.size(), CV_32FC1); // cv::Mat::setTo allocates
  std::fill_n(along_rows_.ptr<float>(), along_rows_.total(), 0.0F);
  for (int y = 0; y < map.rows; ++y)
    for (int i = -reach; i <= reach; ++i) {
      const float weight = weights_[static_cast<std::size_t>(i + reach)];
      const auto *in = map.ptr<float>(y);
      auto *out = along_rows_.ptr<float>(y);
      for (int x = std::max(0, -i); x < std::min(map.cols, map.cols - i); ++x)
        out[x] += weight * in[x + i];
    }
  std::fill_n(map.ptr<float>(), map.total(), 0.0F);
  for (int y = 0; y < map.rows; ++y)
    for (int i = std::max(-reach, -y); i <= std::min(reach, map.rows - 1 - y); ++i) {
      const float weight = weights_[static_cast<std::size_t>(i + reach)];
      const auto *in = along_rows_.ptr<float>(y + i);
      auto *out = map.ptr<float>(y);
      for (int x = 0; x < map.cols; ++x)
        out[x] += weight * in[x];
    }
}

} // namespace saliency
