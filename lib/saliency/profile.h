// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string_view>

namespace saliency {

/// A center-surround pair of pyramid levels, surround = center + δ (paper, Section 3: s = c + δ).
struct LevelPair
{
  int center;
  int surround;

  bool operator==(const LevelPair &) const = default;
};

/// How frames are analyzed.
enum class Method
{
  paper,    ///< Section 3 of the paper, which has its own constants (Paper)
  events,   ///< what moves or appears by itself (EventMap), found by contrast to a coarser level
  pictures, ///< regions enclosed by another color (Surroundedness) of a rare one (Rarity)
};

/// Fewest samples of a map for which the whole picture is judged for shot cuts
/// (Profile::cut_share). In a smaller map a single object may fill most of the picture.
inline constexpr int kFewestSamples = 64;

/// The path from frame to saliency map (docs/design/algorithm.md). A valid profile has 0 ≤ center
/// ≤ surround. Its numbers are ≥ 0 and not NaN. All but `method` and `exact` are without effect on
/// Method::paper.
struct Profile
{
  Method method = Method::events;
  /// Convert every pixel to L*a*b* before decimation, also in large frames (decimation_level()).
  bool exact = false;
  /// Pyramid levels are renumbered: level 2 becomes the level whose larger side is nearest to this
  /// width in octaves, shifted if needed so that no level is below 0. 0: levels are the frame's.
  int reference_width = 220;
  /// w in ΔE = √(ΔL² + w² (Δa² + Δb²)).
  double chroma_weight = 2;
  /// The chroma's level pair is coarser than the lightness' by this many octaves. The eye resolves
  /// color less finely, and films store it at half the resolution, so with more noise.
  int chroma_octaves = 1;
  /// Levels of contrast, limited to those that the frame has. Surroundedness uses the center alone.
  LevelPair levels{ 2, 3 };
  /// ΔE between the thresholds of surroundedness, in [0.5, 100].
  double threshold_step = 3;
  /// p of surroundedness, in [0, 1]: a region counts (1 % of the picture / its area)^p.
  double area_exponent = 0.5;
  /// Level of the saliency map; contrast is resampled to it on the pyramid's grid.
  int saliency_level = 4;
  /// A new shot begins, with an empty history, if more than this share of the pixels change by more
  /// than `cut_contrast` from one frame to the next. 1: never.
  double cut_share = 0.5;
  double cut_contrast = 6; ///< ΔE

  /// The paper to the letter where it is explicit, L*a*b* of every pixel.
  static Profile paper();

  /// The best profile measured on films (docs/measured/quality.md has the figures).
  static Profile tuned();

  /// The best profile measured on single pictures, for analysis without `temporal`: level 3, no
  /// shot cuts.
  static Profile tuned_spatial();
};

/// Why `profile` is invalid; empty if it is valid.
std::string_view fault_of(const Profile &profile);

} // namespace saliency
