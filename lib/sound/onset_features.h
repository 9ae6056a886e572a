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
  /// Hops after a moment that its features need, and more hops with which kLaterCount more
  /// features are known.
  static constexpr int kAhead = 2;
  static constexpr int kLater = 16;

  static constexpr std::size_t kCount = 99;
  static constexpr std::size_t kLaterCount = 40;

  explicit OnsetFeatures(bool looks_ahead);

  /// Takes the next hop. Returns whether anything rises around the hop ahead() before it.
  bool add(const BandPowers &powers);

  int ahead() const
  {
    return kAhead + (looks_ahead_ ? kLater : 0);
  }

  /// The features of that hop, after add() was true.
  std::span<const float> features() const
  {
    return std::span(ours().features).first(looks_ahead_ ? kCount + kLaterCount : kCount);
  }

  /// How far all of it is above all of the 50 ms before.
  float rise_db() const
  {
    return ours().now[kWhole] - ours().past[kWhole];
  }

  /// Powers in the last 50 ms before an impact at that hop, the largest of each band.
  const Powers &before() const
  {
    return ours().before;
  }

  void reset();

  static constexpr int kNow = 5; ///< newest hops that an impact may fill
  static constexpr int kGap
      = 6; ///< hops from here to kPast before the newest are the past of an impact
  static constexpr int kPast = 15;

private:
  /// Hops from here to the oldest are the past of a slow rise, kLater hops later.
  static constexpr int kLongAgo = kLater + 24;
  static constexpr int kHeld = kLongAgo + 16;
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

  /// A moment, and its levels.
  struct Rise
  {
    bool is_any = false;
    Levels now{};
    Levels past{};
    Powers before{};
    std::array<float, kCount + kLaterCount> features{};
  };

  using Shape = std::array<float, kLowBands + kFine>; ///< levels of fine bands, dB
  static constexpr std::size_t kStrokes = 32;

  const Hop &hop(int ago) const;
  const Rise &ours() const;
  void follow(const BandPowers &powers);
  bool compare(Rise &rise);
  void compare_later(Rise &rise) const;
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
  bool looks_ahead_;
  std::array<Rise, kLater + 1> rises_{}; ///< of the last hops
  std::size_t newest_rise_ = 0;
};

} // namespace sound
