// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/events/noise_floor.h"

#include "saliency/dilation.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "saliency/events/noise_floor.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "frame/vectors-inl.h"

#ifndef SALIENCY_NOISE_FLOOR_ONCE
#define SALIENCY_NOISE_FLOOR_ONCE
namespace saliency {
namespace {

constexpr double kSmoothing = 4;   ///< time constant in frames at 30 fps
constexpr double kStretch = 30;    ///< frames
constexpr double kRounding = 1e-3; ///< of times, in frames
constexpr int kReaches = 4;        ///< "around" reaches as far as this part of the map's width
constexpr std::size_t kFewest = 4; ///< stretches after which there is a floor
constexpr float kNothing = 1e9F;
constexpr float kGain = 7;
constexpr float kMost = 14;  ///< that is subtracted, about ΔE 110
constexpr float kStrong = 7; ///< a floor above this, about ΔE 50, begins to be an event

} // namespace
} // namespace saliency
#endif

HWY_BEFORE_NAMESPACE();
namespace saliency::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void
follow(const float *around, float share, std::size_t n, float *smooth, float *present)
{
  each_once<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    const auto before = hn::LoadU(d, smooth + i);
    const auto change = hn::Mul(hn::Set(d, share), hn::Sub(hn::LoadU(d, around + i), before));
    const auto now = hn::Add(before, change);
    hn::StoreU(now, d, smooth + i);
    hn::StoreU(hn::Min(hn::LoadU(d, present + i), now), d, present + i);
  });
}

/// Lowers by the least of `count` stretches.
void
lower(const float *const *stretches, std::size_t count, std::size_t n, float *values)
{
  each_once<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    auto floor = hn::LoadU(d, stretches[0] + i);
    for (std::size_t k = 1; k < count; ++k)
      floor = hn::Min(floor, hn::LoadU(d, stretches[k] + i));
    const auto noise
        = hn::Min(hn::Max(hn::Sub(hn::Set(d, kStrong + 1), floor), hn::Zero(d)), hn::Set(d, 1.0F));
    const auto most = hn::Min(hn::Set(d, kMost), hn::Mul(hn::Set(d, kGain), floor));
    const auto left = hn::Sub(hn::LoadU(d, values + i), hn::Mul(noise, most));
    hn::StoreU(hn::Max(hn::Zero(d), left), d, values + i);
  });
}

} // namespace saliency::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saliency {

HWY_EXPORT(follow);
HWY_EXPORT(lower);

void
NoiseFloor::subtract(cv::Mat &map, double elapsed)
{
  if (!begun_ || smooth_.size() != map.size()) {
    reset();
    begun_ = true;
    smooth_.create(map.size(), CV_32FC1);
    std::fill_n(smooth_.ptr<float>(), smooth_.total(), 0.0F);
    present_.create(map.size(), CV_32FC1);
    std::fill_n(present_.ptr<float>(), present_.total(), kNothing);
    for (auto &least : least_)
      least.create(map.size(), CV_32FC1);
  }
  dilate(map, map.cols / kReaches, along_rows_, around_);
  const auto share = static_cast<float>(1 - std::exp(-elapsed / kSmoothing));
  const std::size_t total = map.total();
  HWY_DYNAMIC_DISPATCH(follow)
  (around_.ptr<float>(), share, total, smooth_.ptr<float>(), present_.ptr<float>());
  if (known_ >= kFewest) {
    std::array<const float *, kStretches + 1> stretches{ present_.ptr<float>() };
    for (std::size_t past = 0; past < known_; ++past)
      stretches[past + 1] = least_[past].ptr<float>();
    HWY_DYNAMIC_DISPATCH(lower)(stretches.data(), known_ + 1, total, map.ptr<float>());
  }
  age_ += elapsed;
  if (age_ < kStretch - kRounding)
    return;
  age_ = std::fmod(age_ + kRounding, kStretch); // so that stretches are alike at any frame rate
  std::swap(least_[next_], present_);
  next_ = (next_ + 1) % kStretches;
  known_ = std::min(known_ + 1, kStretches);
  std::fill_n(present_.ptr<float>(), total, kNothing);
}

void
NoiseFloor::reset()
{
  begun_ = false;
  next_ = 0;
  known_ = 0;
  age_ = 0;
}

} // namespace saliency
#endif
