// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/mat.hpp>

#include <vector>

namespace saliency {

/// A Gaussian blur, with nothing outside of the picture.
class Blur
{
public:
  /// Blurs `map` (CV_32FC1) in place; `sigma` > 0 in samples.
  void operator()(cv::Mat &map, double sigma);

  /// How far it reaches, in samples.
  static int reach(double sigma);

private:
  double sigma_ = 0;
  std::vector<float> weights_;
  cv::Mat along_rows_;
};

} // namespace saliency
