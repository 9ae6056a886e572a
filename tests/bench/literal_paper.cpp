// SPDX-License-Identifier: LGPL-2.1-or-later
#include "literal_paper.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>

namespace bench {

namespace {

constexpr int kSaliencyLevel = 2;
constexpr std::size_t kLongest = 64; // frames: level 6 of the temporal pyramid

/// N(·): scaled to [0, 1], times (1 − m̄)². m̄ is the mean of the local maxima except the global
/// one.
cv::Mat
normalized(cv::Mat map)
{
  cv::normalize(map, map, 0, 1, cv::NORM_MINMAX);
  static const cv::Mat kNeighbors = (cv::Mat_<std::uint8_t>(3, 3) << 1, 1, 1, 1, 0, 1, 1, 1, 1);
  cv::Mat neighbors;
  cv::dilate(map, neighbors, kNeighbors);
  const cv::Mat maxima = map > neighbors;
  const int count = cv::countNonZero(maxima);
  const double sum = cv::mean(map, maxima)[0] * count;
  const double others = count > 1 ? (sum - 1) / (count - 1) : 0;
  return map * ((1 - others) * (1 - others));
}

/// C(c, s) = ‖P_c − up(P_s)‖
cv::Mat
contrast(const cv::Mat &center, const cv::Mat &surround)
{
  cv::Mat difference;
  cv::resize(surround, difference, center.size(), 0, 0, cv::INTER_LINEAR);
  cv::subtract(center, difference, difference);
  cv::multiply(difference, difference, difference);
  cv::Mat map;
  cv::transform(difference, map, cv::Matx13f(1, 1, 1));
  cv::sqrt(map, map);
  return map;
}

} // namespace

const cv::Mat &
LiteralPaper::frame(const cv::Mat &i420)
{
  cv::cvtColor(i420, bgr_, cv::COLOR_YUV2BGR_I420);
  bgr_.convertTo(bgr_float_, CV_32F, 1.0 / 255);
  pyramid_.resize(1);
  cv::cvtColor(bgr_float_, pyramid_[0], cv::COLOR_BGR2Lab);
  while (pyramid_.back().total() > 1) {
    cv::Mat half;
    cv::pyrDown(pyramid_.back(), half);
    pyramid_.push_back(half);
  }

  const auto level = [&](int n) -> const cv::Mat & {
    return pyramid_[std::min(static_cast<std::size_t>(n), pyramid_.size() - 1)];
  };
  cv::Mat spatial = cv::Mat::zeros(level(kSaliencyLevel).size(), CV_32FC1);
  for (int c = 2; c <= 4; c++)
    for (int delta = 3; delta <= 4; delta++) {
      cv::Mat map = normalized(contrast(level(c), level(c + delta)));
      cv::resize(map, map, spatial.size(), 0, 0, cv::INTER_LINEAR);
      spatial += map;
    }

  // T_n: mean of the last 2ⁿ maps.
  history_.push_front(spatial);
  if (history_.size() > kLongest)
    history_.pop_back();
  std::array<cv::Mat, 7> means;
  cv::Mat sum = cv::Mat::zeros(spatial.size(), CV_32FC1);
  std::size_t n = 0;
  for (std::size_t i = 0; i < history_.size(); i++) {
    sum += history_[i];
    if (i + 1 == std::size_t{ 1 } << n)
      means[n++] = sum / static_cast<double>(i + 1);
  }
  for (; n < means.size(); n++)
    means[n] = sum / static_cast<double>(history_.size());

  cv::Mat saliency = cv::Mat::zeros(spatial.size(), CV_32FC1);
  cv::Mat difference;
  for (std::size_t c = 0; c <= 2; c++)
    for (std::size_t delta = 3; delta <= 4; delta++) {
      cv::absdiff(means[c], means[c + delta], difference);
      saliency += difference;
    }
  saliency = normalized(saliency);

  double peak = 0;
  cv::minMaxLoc(saliency, nullptr, &peak);
  cv::threshold(saliency, saliency, peak / 2, 1, cv::THRESH_BINARY);
  // A Gaussian of a third of a cell, on 8 × 8 samples per cell: at full resolution it would cost as
  // much as all steps before.
  cv::resize(saliency, saliency, { 24, 24 }, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(saliency, saliency, {}, 8.0 / 3);
  cv::resize(saliency, tactile_, { 3, 3 }, 0, 0, cv::INTER_LINEAR);
  return tactile_;
}

} // namespace bench
