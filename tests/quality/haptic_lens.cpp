// SPDX-License-Identifier: LGPL-2.1-or-later
#include "haptic_lens.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>

namespace quality {

namespace {

constexpr std::array<std::size_t, 3> kSpatialCenters{ 2, 3, 4 };
constexpr std::array<std::size_t, 3> kTemporalCenters{ 0, 1, 2 };
constexpr std::array<std::size_t, 2> kSurrounds{ 3, 4 }; ///< levels above the center
constexpr std::size_t kLevels = 9;

/// Luma in hundredths of a code, CV_16UC1: integers, so that sums are exact.
cv::Mat
luma_of(const cv::Mat &bgr)
{
  cv::Mat wide;
  bgr.convertTo(wide, CV_16U);
  cv::Mat luma;
  cv::transform(wide, luma, cv::Matx13f(11, 59, 30));
  return luma;
}

/// Stretches a map to [0, 1]. A flat one becomes 0.
void
stretch(cv::Mat &map)
{
  double least = 0;
  double most = 0;
  cv::minMaxLoc(map, &least, &most);
  const double scale = most > least ? 1 / (most - least) : 0;
  map.convertTo(map, CV_32F, scale, -least * scale);
}

} // namespace

void
HapticLens::reset()
{
  count_ = 0;
}

void
HapticLens::remember(const cv::Mat &luma)
{
  if (count_ == 0) {
    frames_.assign(kLongest, {});
    for (auto &sum : sums_)
      sum = cv::Mat::zeros(luma.size(), CV_32SC1);
  }
  for (std::size_t n = 0; n < kWindows; ++n) {
    const std::size_t length = std::size_t{ 1 } << n;
    cv::add(sums_[n], luma, sums_[n], cv::noArray(), CV_32S);
    if (count_ >= length)
      cv::subtract(sums_[n], frames_[(count_ - length) % kLongest], sums_[n], cv::noArray(),
                   CV_32S);
    sums_[n].convertTo(means_[n], CV_32F, 1.0 / static_cast<double>(length));
  }
  luma.copyTo(frames_[count_ % kLongest]);
  ++count_;
}

void
HapticLens::find_spatial(const cv::Mat &luma)
{
  std::array<cv::Mat, kLevels> pyramid;
  luma.convertTo(pyramid[0], CV_32F);
  for (std::size_t i = 1; i < kLevels; ++i)
    cv::pyrDown(pyramid[i - 1], pyramid[i]);

  cv::Mat surround;
  cv::Mat difference;
  spatial_ = cv::Mat::zeros(luma.size(), CV_32FC1);
  for (const std::size_t center : kSpatialCenters) {
    cv::Mat sum = cv::Mat::zeros(pyramid[center].size(), CV_32FC1);
    for (const std::size_t above : kSurrounds) {
      cv::resize(pyramid[center + above], surround, sum.size(), 0, 0, cv::INTER_LINEAR);
      cv::absdiff(pyramid[center], surround, difference);
      sum += difference;
    }
    cv::resize(sum, difference, luma.size(), 0, 0, cv::INTER_LINEAR);
    spatial_ += difference;
  }
  stretch(spatial_);
}

/// False as long as there are too few frames for any difference.
bool
HapticLens::find_temporal()
{
  cv::Mat difference;
  temporal_ = cv::Mat::zeros(means_[0].size(), CV_32FC1);
  bool any = false;
  for (const std::size_t center : kTemporalCenters)
    for (const std::size_t above : kSurrounds)
      if (count_ >= std::size_t{ 1 } << (center + above)) {
        cv::absdiff(means_[center], means_[center + above], difference);
        temporal_ += difference;
        any = true;
      }
  stretch(temporal_);
  return any;
}

const cv::Mat &
HapticLens::film_map(const cv::Mat &frame)
{
  const cv::Mat luma = luma_of(frame);
  remember(luma);
  if (!find_temporal()) {
    map_ = temporal_;
    return map_;
  }
  find_spatial(luma);
  cv::multiply(spatial_, temporal_, map_);
  stretch(map_);
  return map_;
}

const cv::Mat &
HapticLens::picture_map(const cv::Mat &picture)
{
  find_spatial(luma_of(picture));
  return spatial_;
}

} // namespace quality
