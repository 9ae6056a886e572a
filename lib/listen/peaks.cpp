// SPDX-License-Identifier: LGPL-2.1-or-later
#include "listen/peaks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace listen {

namespace {

constexpr float kForgets = 0.016F; ///< least weight of a frame in the average, of a second
constexpr float kFades = 0.1F;     ///< dB a frame
constexpr float kRange = 60;       ///< dB below the loudest that count
constexpr float kSilence = -100;   ///< dB
constexpr float kLeast = 3;        ///< dB above the average

} // namespace

PeakFinder::PeakFinder(int most)
    : most_(static_cast<std::size_t>(most)), fft_(gst_fft_f32_new(kSize, FALSE))
{
  for (int i = 0; i < kSize; i++)
    window_[static_cast<std::size_t>(i)] = static_cast<float>(
        (0.5 - 0.5 * std::cos(2 * std::numbers::pi * (i + 0.5) / kSize)) * 4 / kSize);
  average_.fill(kSilence);
  fresh_ = -kSize / 2 + kHop; // frame 0 is centered at 0 s
}

void
PeakFinder::add(std::span<const float> samples)
{
  while (!samples.empty()) {
    const auto count = std::min(samples.size(), static_cast<std::size_t>(kHop - fresh_));
    const auto shift = static_cast<std::ptrdiff_t>(std::min<std::size_t>(count, kSize));
    std::shift_left(held_.begin(), held_.end(), shift);
    std::copy_n(samples.begin() + static_cast<std::ptrdiff_t>(count) - shift, shift,
                held_.end() - shift);
    samples = samples.subspan(count);
    fresh_ += static_cast<int>(count);
    if (fresh_ == kHop) {
      fresh_ = 0;
      add_frame();
    }
  }
}

void
PeakFinder::add_frame()
{
  std::array<float, kSize> windowed;
  std::array<std::complex<float>, kSize / 2 + 1> bins;
  for (std::size_t i = 0; i < kSize; i++)
    windowed[i] = held_[i] * window_[i];
  gst_fft_f32_fft(fft_.get(), windowed.data(), reinterpret_cast<GstFFTF32Complex *>(bins.data()));
  Row &row = rows_[static_cast<std::size_t>(frames_ % kFrames)];
  float loudest = -200;
  for (std::size_t i = 0; i < kBins; i++) {
    row[i] = 10 * std::log10(std::norm(bins[i + kFirst]) + 1e-20F);
    loudest = std::max(loudest, row[i]);
  }
  loudest_ = std::max(loudest_ - kFades, loudest);
  const float floor = std::max(loudest_ - kRange, kSilence);
  // The first frames have equal weights, so that the first second has the peaks that it has in a
  // longer sound.
  const float weight = std::max(kForgets, 1.0F / static_cast<float>(frames_ + 1));
  for (std::size_t i = 0; i < kBins; i++) {
    const float level = std::max(row[i], floor);
    row[i] = level - average_[i];
    average_[i] += (level - average_[i]) * weight;
  }
  Row &most = most_near_[static_cast<std::size_t>(frames_ % kFrames)];
  for (int i = 0; i < kBins; i++)
    most[static_cast<std::size_t>(i)] = *std::max_element(
        row.begin() + std::max(i - kReach, 0), row.begin() + std::min(i + kReach + 1, kBins));
  if (frames_ >= 2 * kReach)
    look_at(frames_ - kReach);
  frames_++;
}

void
PeakFinder::look_at(std::int64_t frame)
{
  const Row &row = rows_[static_cast<std::size_t>(frame % kFrames)];
  for (std::size_t i = 1; i + 1 < kBins; i++) {
    const float level = row[i];
    if (level < kLeast
        || std::ranges::any_of(most_near_, [&](const Row &most) { return most[i] > level; }))
      continue;
    const float bend = row[i - 1] - 2 * level + row[i + 1];
    const float off
        = bend < 0 ? std::clamp((row[i - 1] - row[i + 1]) / (2 * bend), -0.5F, 0.5F) : 0;
    block_.push_back(
        { .frame = frame, .bin = static_cast<float>(i + kFirst) + off, .strength = level });
  }
  if (frame % kBlock == kBlock - 1)
    end_block();
}

void
PeakFinder::end_block()
{
  if (block_.size() > most_) {
    std::ranges::nth_element(block_, block_.begin() + static_cast<std::ptrdiff_t>(most_),
                             std::ranges::greater(), &Peak::strength);
    block_.resize(most_);
  }
  std::ranges::sort(block_, {}, [](const Peak &peak) { return std::pair(peak.frame, peak.bin); });
  found_.insert(found_.end(), block_.begin(), block_.end());
  block_.clear();
}

std::vector<Peak>
PeakFinder::take()
{
  return std::exchange(found_, {});
}

} // namespace listen
