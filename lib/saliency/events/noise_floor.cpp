// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/events/noise_floor.h"

#include "saliency/dilation.h"

#include <algorithm>
#include <cmath>

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
  auto *smooth = smooth_.ptr<float>();
  auto *present = present_.ptr<float>();
  const auto *around = around_.ptr<float>();
  auto *values = map.ptr<float>();
  const std::size_t total = map.total();
  for (std::size_t i = 0; i < total; ++i) {
    smooth[i] += share * (around[i] - smooth[i]);
    present[i] = std::min(present[i], smooth[i]);
  }
  if (known_ >= kFewest) {
    for (std::size_t i = 0; i < total; ++i) {
      float floor = present[i];
      for (std::size_t past = 0; past < known_; ++past)
        floor = std::min(floor, least_[past].ptr<float>()[i]);
      const float noise = std::clamp(kStrong + 1 - floor, 0.0F, 1.0F);
      values[i] = std::max(0.0F, values[i] - noise * std::min(kMost, kGain * floor));
    }
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
