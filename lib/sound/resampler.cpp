// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/resampler.h"

#include "sound/dot.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace sound {

namespace {

constexpr double kCrossings = 8; ///< zero crossings of the sine on each side
/// Rates with more phases use the nearest of these: 1/512 of a sample.
constexpr std::int64_t kMostPhases = 512;

} // namespace

Resampler::Resampler(int rate, int channels) : rate_(rate), channels_(channels)
{
  phases_ = std::min<std::int64_t>(kRate / std::gcd(rate, kRate), kMostPhases);
  const double cutoff = kPassed * std::min(rate, kRate);
  make_taps(static_cast<int>(std::ceil(kCrossings / cutoff * rate)));
  room_ = static_cast<std::size_t>(taps_ + kBlock);
  held_.resize(room_ * static_cast<std::size_t>(channels));
  reset();
}

void
Resampler::make_taps(int count)
{
  const double cutoff = kPassed * std::min(rate_, kRate) / rate_; // of the rate that comes in
  taps_ = (count + kLanes - 1) / kLanes * kLanes;
  table_.resize(static_cast<std::size_t>(taps_ * phases_));
  for (std::int64_t phase = 0; phase < phases_; phase++) {
    float *taps = &table_[static_cast<std::size_t>(phase * taps_)];
    double sum = 0;
    for (int i = 0; i < taps_; i++) {
      const double at
          = i - taps_ / 2 + 1 - static_cast<double>(phase) / static_cast<double>(phases_);
      const double turn = 2 * std::numbers::pi * cutoff * at;
      const double window = 0.5 + 0.5 * std::cos(2 * std::numbers::pi * at / (taps_ + 1));
      const double tap = window * (turn == 0 ? 1 : std::sin(turn) / turn);
      taps[i] = static_cast<float>(tap);
      sum += tap;
    }
    for (int i = 0; i < taps_; i++)
      taps[i] /= static_cast<float>(sum);
  }
}

double
Resampler::delay() const
{
  return static_cast<double>(taps_ / 2 + 1) / rate_;
}

void
Resampler::reset()
{
  std::ranges::fill(held_, 0.0F);
  // As if silence had come before.
  held_frames_ = static_cast<std::size_t>(taps_ / 2);
  first_ = -static_cast<std::int64_t>(held_frames_);
  next_ = 0;
}

void
Resampler::add(std::span<const float> frames)
{
  const std::size_t count = frames.size() / static_cast<std::size_t>(channels_);
  const std::int64_t needed
      = next_ * rate_ / kRate - taps_ / 2 + 1; // the first frame of the next sum
  const auto done = static_cast<std::size_t>(
      std::clamp<std::int64_t>(needed - first_, 0, static_cast<std::int64_t>(held_frames_)));
  for (std::size_t c = 0; c < static_cast<std::size_t>(channels_); c++) {
    float *held = &held_[c * room_];
    std::copy(held + done, held + held_frames_, held);
    float *end = held + held_frames_ - done;
    for (std::size_t i = 0; i < count; i++) {
      const float sample = frames[i * static_cast<std::size_t>(channels_) + c];
      end[i] = std::isfinite(sample) && std::abs(sample) >= kFaintest
                   ? std::clamp(sample, -kLoudest, kLoudest)
                   : 0.0F;
    }
  }
  held_frames_ += count - done;
  first_ += static_cast<std::int64_t>(done);
}

bool
Resampler::take(std::span<float> frame)
{
  const std::int64_t at = next_ * rate_;
  const std::int64_t phase = at % kRate * phases_ / kRate;
  const std::int64_t from = at / kRate - taps_ / 2 + 1 - first_;
  if (from + taps_ > static_cast<std::int64_t>(held_frames_))
    return false;
  const float *taps = &table_[static_cast<std::size_t>(phase * taps_)];
  for (std::size_t c = 0; c < static_cast<std::size_t>(channels_); c++)
    frame[c] = dot(&held_[c * room_ + static_cast<std::size_t>(from)], taps, taps_);
  next_++;
  return true;
}

} // namespace sound
