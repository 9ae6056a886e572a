// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string_view>
#include <vector>

namespace saliency {

/// A center-surround pair of pyramid levels, surround = center + δ (paper, Section 3: s = c + δ).
struct LevelPair
{
  int center;
  int surround;

  bool operator==(const LevelPair &) const = default;
};

/// A center-surround pair of temporal windows, in frames (level n of the temporal pyramid is 2ⁿ
/// frames).
struct WindowPair
{
  int center;
  int surround;
};

/// The cue for saliency within a single picture.
enum class SpatialCue
{
  contrast,       ///< ΔE to its surround, a coarser level of the pyramid
  surroundedness, ///< being enclosed by another color (Surroundedness)
};

/// Whether N(·) of Itti & Koch is applied.
enum class Normalization
{
  none,
  itti, ///< scale to [0, 1], multiply by (1 − m̄)²
};

/// How films are followed.
enum class Temporal
{
  windows, ///< temporal contrast between means over windows of frames (paper)
  events,  ///< what moves or appears by itself (EventMap)
};

/// Fewest samples of a map for which the whole picture is judged for shot cuts
/// (Profile::cut_share). In a smaller map a single object may fill most of the picture.
inline constexpr int kFewestSamples = 64;

/// All parameters of the path from frame to saliency map (docs/design/algorithm.md). A valid
/// profile has level pairs with 0 ≤ center ≤ surround and window pairs of at least 1. Its numbers
/// are ≥ 0 and not NaN.
struct Profile
{
  /// Convert every pixel to L*a*b* before decimation, also in large frames (decimation_level()).
  bool exact = false;
  /// 0: pyramid levels are the frame's own. Otherwise they are renumbered: level 2 becomes the
  /// level whose larger side is nearest to this width in octaves, shifted if needed so that no
  /// level is below 0.
  int reference_width = 0;
  /// w in ΔE = √(ΔL² + w² (Δa² + Δb²)).
  double chroma_weight = 1;
  /// The chroma's level pairs are coarser than the lightness' by this many octaves. The eye
  /// resolves color less finely, and films store it at half the resolution, so with more noise.
  int chroma_octaves = 0;
  SpatialCue spatial_cue = SpatialCue::contrast;
  /// Level pairs of the spatial contrast maps, limited to the levels that the frame has.
  /// Surroundedness uses the center level alone.
  std::vector<LevelPair> levels;
  /// ΔE between the thresholds of surroundedness, in [0.5, 100].
  double threshold_step = 3;
  /// p of surroundedness, in [0, 1]: a region counts (1 % of the picture / its area)^p.
  double area_exponent = 0.5;
  /// Applied to each contrast map before they are combined.
  Normalization contrast_normalization = Normalization::none;
  /// Combine contrast maps by their mean rather than their sum.
  bool contrast_mean = false;
  /// Level of the spatial saliency map; contrast maps are resampled to it on the pyramid's grid.
  int saliency_level = 2;
  /// Multiply the spatial saliency map by color rarity, computed at the coarsest center level.
  bool rarity = false;
  Temporal temporal = Temporal::windows;
  /// Window pairs of the temporal contrast maps, for Temporal::windows.
  std::vector<WindowPair> windows;
  /// A new shot begins, with an empty history, if more than this share of the pixels change by more
  /// than `cut_contrast` from one frame to the next. 1: never.
  double cut_share = 1;
  double cut_contrast = 6; ///< ΔE
  /// Applied to the spatiotemporal saliency map.
  Normalization temporal_normalization = Normalization::none;

  /// The paper to the letter where it is explicit: c ∈ {2,3,4}, δ ∈ {3,4}, N(·), absolute temporal
  /// differences of levels c ∈ {0,1,2}, s = c + {3,4}, L*a*b* per pixel.
  static Profile paper();

  /// The best profile measured on films (docs/measured/quality.md has the figures): events, whose
  /// onsets are found by contrast of one pair c = 2, δ = 1, chroma × 2, no N(·), pooled to level 4.
  static Profile tuned();

  /// The best profile measured on single pictures, for analysis without `temporal`: surroundedness
  /// at level 3 times color rarity, no shot cuts. Otherwise as tuned().
  static Profile tuned_spatial();
};

/// Why `profile` is invalid; empty if it is valid.
std::string_view fault_of(const Profile &profile);

} // namespace saliency
