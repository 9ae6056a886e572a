// SPDX-License-Identifier: LGPL-2.1-or-later
#include "listen/onsets.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace listen {

namespace {

/// Middles of the bands, in Hz, and their quality.
constexpr std::array<double, kBands> kMiddles = { 250, 356, 508, 724, 1032, 1471, 2098, 2991 };
constexpr double kQuality = 2;
constexpr float kFaint = 1e-10F; ///< power, −100 dB
constexpr int kDelay = 2;        ///< of an onset, in steps
constexpr float kForgets = 0.008F;
// Weights of changes, by their level above the one that a third of them do not exceed.
constexpr float kOfFloor = 0.5F;
constexpr float kOfLevel = 1.0F / 3; ///< of log power
constexpr float kLeast = 0.15F;
constexpr float kMost = 1.5F;

} // namespace

Onsets::Onsets()
{
  for (std::size_t band = 0; band < kBands; band++) {
    const double turn = 2 * std::numbers::pi * kMiddles[band] / kRate;
    const double alpha = std::sin(turn) / (2 * kQuality);
    filters_[band].b0 = static_cast<float>(alpha / (1 + alpha));
    filters_[band].a1 = static_cast<float>(-2 * std::cos(turn) / (1 + alpha));
    filters_[band].a2 = static_cast<float>((1 - alpha) / (1 + alpha));
    levels_[band].fill(std::log(kFaint));
    mean_[band] = 0.3F;
  }
}

float
Onsets::Filter::pass(float sample)
{
  for (std::size_t twice = 0; twice < 4; twice += 2) {
    const float out = b0 * (sample - x[twice + 1]) - a1 * y[twice] - a2 * y[twice + 1];
    x[twice + 1] = std::exchange(x[twice], sample);
    y[twice + 1] = std::exchange(y[twice], std::abs(out) > 1e-15F ? out : 0.0F);
    sample = out;
  }
  return sample;
}

void
Onsets::add(std::span<const float> samples)
{
  for (const float sample : samples) {
    for (std::size_t band = 0; band < kBands; band++) {
      const float out = filters_[band].pass(sample);
      power_[band] += out * out;
    }
    if (++fresh_ == kHop) {
      fresh_ = 0;
      add_power();
    }
  }
}

void
Onsets::add_power()
{
  Onset onset{};
  for (std::size_t band = 0; band < kBands; band++) {
    auto &levels = levels_[band];
    std::shift_left(levels.begin(), levels.end(), 1);
    levels.back() = std::log(std::exchange(power_[band], 0.0F) / kHop + kFaint);
    const auto last = levels.end();
    const float change = (last[-1] + last[-2]) - (last[-3] + last[-4]);
    mean_[band] += (std::abs(change) - mean_[band]) * kForgets;
    onset.change[band] = std::clamp(change / (2 * mean_[band] + 1e-3F), -1.0F, 1.0F);
    onset.level[band] = (last[-1] + last[-2] + last[-3] + last[-4]) / 4;
  }
  if (++count_ >= kDelay)
    found_.push_back(onset);
}

std::vector<Onset>
Onsets::take()
{
  return std::exchange(found_, {});
}

std::uint8_t
signs(const Onset &onset)
{
  std::uint8_t bits = 0;
  for (std::size_t band = 0; band < kBands; band++)
    bits |= static_cast<std::uint8_t>((onset.change[band] > 0 ? 1U : 0U) << band);
  return bits;
}

std::vector<Bands>
weighted(std::span<const Onset> onsets)
{
  std::vector<Bands> changes(onsets.size());
  std::vector<float> levels(onsets.size());
  for (std::size_t band = 0; band < kBands; band++) {
    std::ranges::transform(onsets, levels.begin(),
                           [&](const Onset &one) { return one.level[band]; });
    const auto third = levels.begin() + static_cast<std::ptrdiff_t>(levels.size() / 3);
    std::ranges::nth_element(levels, third);
    for (std::size_t n = 0; n < onsets.size(); n++)
      changes[n][band]
          = onsets[n].change[band]
            * std::clamp(kOfFloor + kOfLevel * (onsets[n].level[band] - *third), kLeast, kMost);
  }
  return changes;
}

} // namespace listen
