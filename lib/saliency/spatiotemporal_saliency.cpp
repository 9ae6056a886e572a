// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/spatiotemporal_saliency.h"

#include "saliency/normalization.h"

#include <algorithm>
#include <cmath>

namespace saliency {

SpatiotemporalSaliency::SpatiotemporalSaliency(const Profile &profile)
    : sign_(profile.temporal_sign), mean_(profile.temporal_mean),
      normalization_(profile.temporal_normalization)
{
  const auto place = [this](int window) {
    const auto found = std::find(windows_.begin(), windows_.end(), window);
    const auto index = static_cast<std::size_t>(found - windows_.begin());
    if (found == windows_.end())
      windows_.push_back(window);
    return index;
  };
  for (const auto &pair : profile.windows) {
    const auto center = place(pair.center);
    pairs_.push_back({ center, place(pair.surround) });
  }
  means_.resize(windows_.size());
}

const cv::Mat &
SpatiotemporalSaliency::compute(const TemporalPyramid &history)
{
  for (std::size_t i = 0; i < windows_.size(); ++i)
    history.mean(windows_[i], means_[i]);

  saliency_.create(means_.at(0).size(), CV_32FC1);
  saliency_.setTo(0);
  const float weight = mean_ ? 1.0F / static_cast<float>(pairs_.size()) : 1.0F;
  for (const auto &pair : pairs_)
    for (int y = 0; y < saliency_.rows; ++y) {
      const auto *center = means_[pair.center].ptr<float>(y);
      const auto *surround = means_[pair.surround].ptr<float>(y);
      auto *out = saliency_.ptr<float>(y);
      if (sign_ == TemporalSign::onset)
        for (int x = 0; x < saliency_.cols; ++x)
          out[x] += weight * std::max(0.0F, center[x] - surround[x]);
      else
        for (int x = 0; x < saliency_.cols; ++x)
          out[x] += weight * std::abs(center[x] - surround[x]);
    }

  if (normalization_ == Normalization::itti)
    normalize_itti(saliency_);
  return saliency_;
}

} // namespace saliency
