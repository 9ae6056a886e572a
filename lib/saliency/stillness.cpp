// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/stillness.h"

#include "saliency/quantile.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace saliency {

namespace {

constexpr float kUnit = 0.65F;      ///< ΔE of a code at most, of lightness or weighted color
constexpr float kNoise = 0.31F;     ///< ΔE, of the best of pictures
constexpr float kMostNoise = 0.25F; ///< ΔE more: with more, more than half of the picture changes
constexpr float kAllowed = 1.25F;   ///< σ of the noise
constexpr int kGroup = 4;           ///< blocks of each side
constexpr int kSampled = 7;         ///< of every seventh block, the noise

} // namespace

bool
Stillness::operator()(const FrameView &frame, int level, double beyond)
{
  const std::array<cv::Mat1f, 3> &now = means_(frame, level);
  bool same_all = known_;
  for (std::size_t i = 0; i < now.size() && same_all; ++i)
    same_all = now[i].size() == reference_[i].size()
               && same(now[i], reference_[i], static_cast<float>(beyond));
  if (!same_all)
    for (std::size_t i = 0; i < now.size(); ++i)
      now[i].copyTo(reference_[i]);
  known_ = true;
  return same_all;
}

void
Stillness::prepare(const FrameView &frame, int level)
{
  keep(frame, level);
  for (const cv::Mat1f &means : reference_) {
    differences_.reserve(means.total() / kSampled + 1);
    beyond_.reserve(static_cast<std::size_t>(means.cols / kGroup + 1));
  }
  reset();
}

void
Stillness::keep(const FrameView &frame, int level)
{
  known_ = false;
  (*this)(frame, level, 0);
}

bool
Stillness::same(const cv::Mat1f &now, const cv::Mat1f &before, float beyond)
{
  if (now.empty())
    return true;
  differences_.clear();
  for (std::size_t i = 0; i < now.total(); i += kSampled)
    differences_.push_back(kUnit * std::abs(now.ptr<float>()[i] - before.ptr<float>()[i]));
  constexpr float kSigmas = 1.48F; // of the median
  const float noise = kNoise + std::min(kMostNoise, kSigmas * quantile(differences_, 0.5));
  const auto groups = static_cast<std::size_t>((now.cols + kGroup - 1) / kGroup);
  for (int y = 0; y < now.rows; ++y) {
    if (y % kGroup == 0)
      beyond_.assign(groups, 0);
    const float *a = now.ptr<float>(y);
    const float *b = before.ptr<float>(y);
    for (int x = 0; x < now.cols; ++x)
      beyond_[static_cast<std::size_t>(x / kGroup)]
          += std::max(0.0F, kUnit * std::abs(a[x] - b[x]) - kAllowed * noise);
    if (*std::ranges::max_element(beyond_) > beyond * kGroup * kGroup)
      return false;
  }
  return true;
}

} // namespace saliency
