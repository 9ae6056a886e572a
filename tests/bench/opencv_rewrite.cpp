// SPDX-License-Identifier: LGPL-2.1-or-later
#include "opencv_rewrite.h"

#include "saliency/profile.h"
#include "saliency/spatial_saliency.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace bench {

namespace {

/// √(ΔL² + 4 (Δa² + Δb²)) of a level and the next coarser one.
cv::Mat
difference_squared(const cv::Mat &center, const cv::Mat &surround, const cv::Matx13f &weights)
{
  cv::Mat up;
  cv::resize(surround, up, center.size(), 0, 0, cv::INTER_LINEAR);
  cv::Mat difference;
  cv::absdiff(center, up, difference);
  cv::multiply(difference, difference, difference, 1, CV_32F);
  cv::Mat sum;
  cv::transform(difference, sum, weights);
  return sum;
}

} // namespace

OpencvRewrite::OpencvRewrite(cv::Size frame, bool decimate_first)
    : frame_(frame), decimate_first_(decimate_first),
      level_(saliency::frame_levels(saliency::Profile::tuned(), frame).finest),
      cumulative_(kLongest + 1)
{
}

void
OpencvRewrite::decimated_lab(const cv::Mat &i420)
{
  const int cw = frame_.width / 2;
  const int ch = frame_.height / 2;
  const std::size_t luma
      = static_cast<std::size_t>(frame_.width) * static_cast<std::size_t>(frame_.height);
  const cv::Mat sources[]
      = { i420.rowRange(0, frame_.height), cv::Mat(ch, cw, CV_8UC1, i420.data + luma),
          cv::Mat(ch, cw, CV_8UC1, i420.data + luma + luma / 4) };
  cv::Mat small[3];
  for (int i = 0; i < 3; i++) {
    small[i] = sources[i];
    planes_[i].resize(static_cast<std::size_t>(level_));
    for (int octave = i == 0 ? 0 : 1; octave < level_; octave++) {
      cv::Mat &half = planes_[i][static_cast<std::size_t>(octave)];
      cv::pyrDown(small[i], half);
      small[i] = half;
    }
  }
  if (level_ == 0)
    for (int i = 1; i < 3; i++)
      cv::resize(sources[i], small[i], frame_, 0, 0, cv::INTER_LINEAR);
  // Limited range becomes full range; then OpenCV's Y'CrCb.
  const cv::Mat components[]
      = { (small[0] - 16) * (255.0 / 219), (small[2] - 128) * (255.0 / 224) + 128,
          (small[1] - 128) * (255.0 / 224) + 128 };
  cv::merge(components, 3, ycrcb_);
  cv::cvtColor(ycrcb_, bgr_, cv::COLOR_YCrCb2BGR);
  cv::cvtColor(bgr_, lab_[0], cv::COLOR_BGR2Lab);
}

void
OpencvRewrite::lab_of_every_pixel(const cv::Mat &i420)
{
  cv::cvtColor(i420, bgr_, cv::COLOR_YUV2BGR_I420);
  cv::cvtColor(bgr_, ycrcb_, cv::COLOR_BGR2Lab);
  planes_[0].resize(static_cast<std::size_t>(level_));
  cv::Mat lab = ycrcb_;
  for (cv::Mat &half : planes_[0]) {
    cv::pyrDown(lab, half);
    lab = half;
  }
  lab_[0] = lab;
}

const cv::Mat &
OpencvRewrite::frame(const cv::Mat &i420)
{
  lab_.resize(3);
  decimate_first_ ? decimated_lab(i420) : lab_of_every_pixel(i420);
  cv::pyrDown(lab_[0], lab_[1]);
  cv::pyrDown(lab_[1], lab_[2]);

  // OpenCV's 8-bit L* is 255/100 too large.
  luma_ = difference_squared(lab_[0], lab_[1], { 100.0F * 100 / 255 / 255, 0, 0 });
  chroma_ = difference_squared(lab_[1], lab_[2], { 0, 4, 4 });
  cv::resize(chroma_, surround_, luma_.size(), 0, 0, cv::INTER_LINEAR);
  cv::add(luma_, surround_, luma_);
  cv::sqrt(luma_, luma_);
  cv::pyrDown(luma_, center_);
  cv::pyrDown(center_, chroma_);

  cv::Mat &now = cumulative_[count_ % cumulative_.size()];
  if (count_ == 0)
    chroma_.convertTo(now, CV_64F);
  else
    cv::add(chroma_, cumulative_[(count_ - 1) % cumulative_.size()], now, cv::noArray(), CV_64F);
  cv::Mat saliency = cv::Mat::zeros(chroma_.size(), CV_32FC1);
  const auto mean = [&](std::size_t window) {
    cv::Mat map;
    window = std::min(window, count_);
    if (window == 0)
      return chroma_;
    cv::subtract(now, cumulative_[(count_ - window) % cumulative_.size()], map);
    map.convertTo(map, CV_32F, 1.0 / static_cast<double>(window));
    return map;
  };
  for (std::size_t window = 1; window <= 8; window *= 2) {
    const cv::Mat onset = mean(window) - mean(8 * window);
    cv::accumulate(cv::max(onset, 0), saliency);
  }
  saliency *= 0.25;
  count_++;

  double peak = 0;
  double strongest = 0;
  cv::minMaxLoc(saliency, nullptr, &peak);
  cv::resize(saliency, tactile_, { 3, 3 }, 0, 0, cv::INTER_AREA);
  cv::minMaxLoc(tactile_, nullptr, &strongest);
  cv::threshold(tactile_, tactile_, peak > 0.6 ? strongest / 2 : strongest, 0, cv::THRESH_TOZERO);
  return tactile_;
}

} // namespace bench
