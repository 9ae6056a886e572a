// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/spatiotemporal_saliency.h"

#include "saliency/dilation.h"
#include "saliency/normalization.h"
#include "saliency/quantile.h"
#include "saliency/rows.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace saliency {

SpatiotemporalSaliency::SpatiotemporalSaliency(const Profile &profile)
    : sign_(profile.temporal_sign), mean_(profile.temporal_mean),
      illumination_guard_(profile.illumination_guard), camera_dilation_(profile.camera_dilation),
      camera_margin_(profile.camera_margin), camera_rim_(profile.camera_rim),
      camera_background_(static_cast<float>(profile.camera_background)),
      background_gain_(profile.background_gain), background_quantile_(profile.background_quantile),
      background_limit_(profile.background_limit), normalization_(profile.temporal_normalization)
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
  light_.assign(pairs_.size(), 1.0F);
  sorted_.resize(pairs_.size());
}

cv::Mat &
SpatiotemporalSaliency::compute(TemporalPyramid &history, const Team &team)
{
  const bool moved = history.moved();
  history.means(windows_, means_, team);

  saliency_.create(means_.at(0).size(), CV_32FC1);
  std::fill_n(saliency_.ptr<float>(), saliency_.total(), 0.0F); // cv::Mat::setTo allocates
  if (illumination_guard_)
    team.each(static_cast<int>(pairs_.size()), [this](int pair) {
      const auto i = static_cast<std::size_t>(pair);
      light_[i] = illumination(means_[pairs_[i].center], means_[pairs_[i].surround], sorted_[i]);
    });
  const float weight = mean_ ? 1.0F / static_cast<float>(pairs_.size()) : 1.0F;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const Pair &pair = pairs_[i];
    const cv::Mat *surrounds = &means_[pair.surround];
    if (moved) {
      dilate(*surrounds, camera_dilation_, along_rows_, dilated_);
      surrounds = &dilated_;
    }
    const float factor = light_[i] * (moved ? static_cast<float>(camera_margin_) : 1.0F);
    for (int y = 0; y < saliency_.rows; ++y) {
      const auto *center = means_[pair.center].ptr<float>(y);
      const auto *surround = surrounds->ptr<float>(y);
      auto *out = saliency_.ptr<float>(y);
      if (sign_ == TemporalSign::onset)
        for (int x = 0; x < saliency_.cols; ++x)
          out[x] += weight * std::max(0.0F, center[x] - factor * surround[x]);
      else
        for (int x = 0; x < saliency_.cols; ++x)
          out[x] += weight * std::abs(center[x] - factor * surround[x]);
    }
  }

  cv::Rect within({}, saliency_.size());
  if (const int rim = camera_rim_;
      moved && rim > 0 && saliency_.cols > 2 * rim && saliency_.rows > 2 * rim) {
    within = { rim, rim, saliency_.cols - 2 * rim, saliency_.rows - 2 * rim };
    for (int y = 0; y < saliency_.rows; ++y) {
      auto *row = saliency_.ptr<float>(y);
      const bool silent = y < rim || y >= saliency_.rows - rim;
      std::fill_n(row, silent ? saliency_.cols : rim, 0.0F);
      std::fill_n(row + saliency_.cols - rim, rim, 0.0F);
    }
  }
  if (background_gain_ > 0)
    subtract_background(within, moved ? camera_background_ : 0);
  if (normalization_ == Normalization::itti)
    normalize_itti(saliency_);
  return saliency_;
}

/// β: the median gain of all samples with contrast, at least 1 (Profile::illumination_guard).
float
SpatiotemporalSaliency::illumination(const cv::Mat &center, const cv::Mat &surround,
                                     std::vector<float> &sorted)
{
  constexpr float kContrast = 1; // smallest contrast that counts, in map units
  constexpr float kNothing = 0.05F;
  constexpr double kEnough = 0.3; // share of the map that must have contrast

  const std::size_t total = center.total();
  if (total < kFewestSamples)
    return 1;
  sorted.resize(total);
  const auto [count, gained] = rows::gains(center.ptr<float>(), surround.ptr<float>(), kContrast,
                                           kNothing, total, sorted.data());
  if (static_cast<double>(count) <= kEnough * static_cast<double>(total)
      || 2 * gained < count) // then the median is at most 1
    return 1;
  sorted.resize(count);
  return std::max(1.0F, quantile(sorted, 0.5));
}

void
SpatiotemporalSaliency::subtract_background(const cv::Rect &within, float raised)
{
  if (within.area() < kFewestSamples)
    return;
  const cv::Mat seen = saliency_(within);
  std::vector<float> &sorted = sorted_.front();
  sorted.clear();
  for (int y = 0; y < seen.rows; ++y)
    sorted.insert(sorted.end(), seen.ptr<float>(y), seen.ptr<float>(y) + seen.cols);
  const auto background
      = raised
        + static_cast<float>(std::min(
            background_limit_,
            background_gain_ * static_cast<double>(quantile(sorted, background_quantile_))));
  for (int y = 0; y < saliency_.rows; ++y) {
    auto *row = saliency_.ptr<float>(y);
    for (int x = 0; x < saliency_.cols; ++x)
      row[x] = std::max(0.0F, row[x] - background);
  }
}

} // namespace saliency
