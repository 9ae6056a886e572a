// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sound/bands.h"

#include <array>
#include <span>

namespace sound {

/// Computes features of each moment from band powers, which separate impacts from voices, notes and
/// drums.
///
/// Levels are compared with those just before, with the usual ones (running quantiles) and with the
/// loudest, which decays. All features are in dB but voicing, which counts 10 if it is full.
class OnsetFeatures
{
public:
  /// Hops after a moment that its features need.
  static constexpr int kAhead = 2;

  static constexpr int kCount = 109;
  /// Later hops, and features of them, with which kAhead more is known.
  static constexpr int kLater = 16;
  static constexpr int kLaterCount = 30;

  OnsetFeatures();

  /// Takes the next hop. Returns whether anything rises around the hop kAhead before it.
  bool add(const BandPowers &powers);

  /// The features of that hop, after add() was true.
  std::span<const float, kCount> features() const
  {
    return features_;
  }

  /// The features of the hop kAhead + kLater before the last, and of the kLater hops after it;
  /// empty if nothing rose there.
  std::span<const float> later_features();

  /// Powers in the last 50 ms before an impact at that hop, the largest of each band.
  const Powers &before() const
  {
    return before_;
  }

  void reset();

  static constexpr int kNow = 5; ///< newest hops that an impact may fill
  static constexpr int kGap
      = 6; ///< hops from here to kPast before the newest are the past of an impact
  static constexpr int kPast = 15;

private:
  static constexpr int kLongAgo = 24; ///< hops from here to the oldest are the past of a slow rise
  static constexpr int kHeld = 40;
  static constexpr std::size_t kFine = 12;      ///< bands of single bins' mean levels
  static constexpr std::size_t kWhole = kBands; ///< index of all bands' level
  static constexpr std::size_t kLevels = kWhole + 1;
  static constexpr float kFloor = -75; ///< dB; lower levels count as this

  using Levels = std::array<float, kLevels>;

  /// A level's usual range: quantiles that follow it, and the loudest.
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

  using Shape = std::array<float, kLowBands + kFine>; ///< levels of fine bands, dB
  static constexpr std::size_t kStrokes = 32;

  const Hop &hop(int ago) const;
  void follow(const BandPowers &powers);
  bool compare();
  void remember(const Shape &shape);
  void compare_strokes(const Shape &shape, float *out) const;

  std::array<Hop, kHeld> hops_{};
  int newest_ = 0;
  int known_ = 0; ///< hops since the reset, up to kHeld
  float flux_95_ = 0;
  float flux_99_ = 0;
  float flux_most_ = 0;
  std::array<float, kPast> fluxes_{}; ///< the newest first
  std::array<Shape, kPast> shapes_{}; ///< of the same hops
  std::array<Shape, kStrokes> strokes_{};
  std::size_t newest_stroke_ = 0; ///< how many there were
  std::array<float, kCount> features_{};
  Powers before_{};

  /// A moment whose later hops come.
  struct Kept
  {
    bool rises = false;
    Levels now{};
    Levels past{};
    std::array<float, kCount + kLaterCount> features{};
  };

  std::array<Kept, kLater + 1> kept_{};
  std::size_t newest_kept_ = 0;
};

} // namespace sound
