// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sound/bands.h"

#include <array>
#include <span>

namespace sound {

/// Band powers over time → what tells impacts from voices, notes and drums about each moment.
///
/// Levels are compared with those just before, with what is usual (running quantiles) and with the
/// loudest, which is forgotten. All is in dB but for voicing, which counts 10 if it is full.
class OnsetFeatures
{
public:
  /// Hops after a moment that have to be known, and those more of a listener who can wait.
  static constexpr int kAhead = 2;
  static constexpr int kLater = 16;

  static constexpr int kSoonCount = 93;
  static constexpr int kCount = kSoonCount + 36;

  explicit OnsetFeatures(bool waits);

  /// How many hops after a moment it is known.
  int ahead() const
  {
    return kAhead + later_;
  }

  /// Takes the next hop. True if anything rises about the hop ahead() before it.
  bool add(const BandPowers &powers);

  /// Of that hop, once add() was true: kSoonCount, or kCount of them if the listener waits.
  std::span<const float> features() const
  {
    return std::span(features_).first(later_ > 0 ? kCount : kSoonCount);
  }

  /// Powers in the last 50 ms before an impact at that hop, the largest of each band.
  const Powers &before() const
  {
    return before_;
  }

  void reset();

  static constexpr int kNow = 5; ///< newest hops that an impact may fill
  static constexpr int kGap = 6; ///< from here to kPast before the newest is what was before it
  static constexpr int kPast = 15;

private:
  static constexpr int kHeld = kPast + kLater + 1;
  static constexpr std::size_t kFine = 12;      ///< bands of single bins' mean levels
  static constexpr std::size_t kWhole = kBands; ///< index of all bands' level
  static constexpr std::size_t kLevels = kWhole + 1;
  static constexpr float kFloor = -75; ///< dB; what is below counts as that

  using Levels = std::array<float, kLevels>;

  /// What is usual of a level: quantiles that follow it, and the loudest.
  struct Usual
  {
    Levels half{};
    Levels most{};
    Levels nearly_all{};
    Levels loudest{};
  };

  struct Hop
  {
    Powers power{};
    Levels db{};
    std::array<float, kFine> fine{};
    Powers uneven{};
    Usual usual;
    float voicing = 0;
    float spoken = 0;       ///< how much of the last half second was voiced
    float loud_voice = -60; ///< dB of the loudest vowel; forgotten by 10 dB a second
  };

  const Hop &hop(int ago) const;
  void follow(const BandPowers &powers);
  bool compare();
  void add_later(const Levels &now, float *out) const;

  int later_;
  std::array<Hop, kHeld> hops_{};
  int newest_ = 0;
  int known_ = 0; ///< hops since the reset, up to kHeld
  float flux_95_ = 0;
  float flux_99_ = 0;
  float flux_most_ = 0;
  std::array<float, kPast> fluxes_{}; ///< the newest first
  std::array<float, kCount> features_{};
  Powers before_{};
};

} // namespace sound
