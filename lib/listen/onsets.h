// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "listen/peaks.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace listen {

inline constexpr std::size_t kBands = 8;

/// A number of each band.
using Bands = std::array<float, kBands>;

/// The change of loudness in each band.
struct Onset
{
  Bands change; ///< from −1 to 1
  Bands level;  ///< of loudness: log of power
};

/// Computes kOnsetRate onsets a second from sound at kRate. A film's reference has only their
/// signs, from which the sound cannot be restored.
class Onsets
{
public:
  static constexpr int kHop = 32; ///< samples: 4 ms
  static constexpr int kOnsetRate = kRate / kHop;

  Onsets();

  void add(std::span<const float> samples);

  /// The onsets since the last call. The very first is at 0 s.
  std::vector<Onset> take();

private:
  /// A band-pass of the second order, twice.
  struct Filter
  {
    float b0 = 0;
    float a1 = 0;
    float a2 = 0;
    std::array<float, 4> x{};
    std::array<float, 4> y{};
    float pass(float sample);
  };

  void add_power();

  static constexpr int kDepth = 8; ///< powers that are kept

  std::array<Filter, kBands> filters_{};
  std::array<float, kBands> power_{};
  std::array<std::array<float, kDepth>, kBands> levels_{};
  std::array<float, kBands> mean_{}; ///< of the size of changes
  int fresh_ = 0;
  std::int64_t count_ = 0;
  std::vector<Onset> found_;
};

/// The signs of an onset, a bit for each band.
std::uint8_t signs(const Onset &onset);

/// Changes with weights: those at a level that the band exceeds most of the time count least,
/// because they may be those of a noise.
std::vector<Bands> weighted(std::span<const Onset> onsets);

} // namespace listen
