// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/spatiotemporal_saliency.h"

#include "saliency/normalization.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace saliency {

SpatiotemporalSaliency::SpatiotemporalSaliency(const Profile &profile)
    : normalization_(profile.temporal_normalization)
{
  for (const auto &pair : profile.windows) {
    windows_.push_back(pair.center);
    windows_.push_back(pair.surround);
  }
  std::ranges::sort(windows_);
  windows_.erase(std::unique(windows_.begin(), windows_.end()), windows_.end());
  const auto place = [this](int window) {
    return static_cast<std::size_t>(std::ranges::find(windows_, window) - windows_.begin());
  };
  for (const auto &pair : profile.windows)
    pairs_.push_back({ place(pair.center), place(pair.surround) });
}

const cv::Mat &
SpatiotemporalSaliency::compute(const TemporalPyramid &history, const Team &team)
{
  history.means(windows_, means_, team);
  saliency_.create(means_.at(0).size(), CV_32FC1);
  std::fill_n(saliency_.ptr<float>(), saliency_.total(), 0.0F); // cv::Mat::setTo allocates
  for (const Pair &pair : pairs_) {
    const auto *center = means_[pair.center].ptr<float>();
    const auto *surround = means_[pair.surround].ptr<float>();
    auto *out = saliency_.ptr<float>();
    for (std::size_t i = 0; i < saliency_.total(); ++i)
      out[i] += std::abs(center[i] - surround[i]);
  }
  if (normalization_ == Normalization::itti)
    normalize_itti(saliency_);
  return saliency_;
}

} // namespace saliency
