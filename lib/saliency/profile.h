// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <limits>
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

/// A center-surround pair of temporal windows, in frames at 30 fps (level n of the temporal pyramid
/// is 2ⁿ frames).
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

/// Which temporal differences count.
enum class TemporalSign
{
  absolute, ///< |center − surround|: disappearing objects count too (a ghost for up to 64 frames)
  onset,    ///< max(0, center − surround): only appearing objects count
};

/// The unit of temporal windows.
enum class TimeBase
{
  frames,  ///< frames of any duration
  seconds, ///< 1/30 s, at any frame rate
};

/// Initial content of the history.
enum class HistoryStart
{
  empty,  ///< nothing: windows average the existing maps
  filled, ///< the first map, held forever: no burst after start, seek or cut
};

/// Fewest samples of a map for which the whole picture is judged: shot cuts (Profile::cut_share),
/// changes of light (illumination_guard), the background level (background_gain). In a smaller map
/// a single object may fill most of the picture.
inline constexpr int kFewestSamples = 64;

/// All parameters of the path from frame to saliency map (docs/design/algorithm.md). A valid
/// profile has level pairs with 0 ≤ center ≤ surround and window pairs of at least 1. Its numbers
/// are ≥ 0 and not NaN, its quantiles in [0, 1]. camera_motion requires TimeBase::seconds.
struct Profile
{
  /// Convert every pixel to L*a*b* before decimation, even in large frames (conversion_level()).
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
  /// Window pairs of the temporal contrast maps.
  std::vector<WindowPair> windows;
  TemporalSign temporal_sign = TemporalSign::absolute;
  /// Combine temporal contrast maps by their mean rather than their sum.
  bool temporal_mean = false;
  TimeBase time_base = TimeBase::seconds;
  HistoryStart history_start = HistoryStart::filled;
  /// Illumination guard: if most samples with contrast gain it by a common factor β, the light has
  /// changed rather than the scene, and surrounds are multiplied by β.
  bool illumination_guard = false;
  /// Estimate camera motion and align the history with it (TimeBase::seconds only). While the
  /// history contains motion, the next three fields apply.
  bool camera_motion = false;
  /// Dilate surrounds by this many samples: the estimated motion is inexact, and real motion is not
  /// a similarity everywhere.
  int camera_dilation = 0;
  /// Multiply surrounds by this: contrast varies a little with the position of the sampling grid.
  double camera_margin = 1;
  /// Set a rim of this many samples to zero, where new content enters the picture. Maps of at most
  /// twice this size have no rim.
  int camera_rim = 0;
  /// Raise the background level by this, in the map's units: parallax leaves differences that no
  /// similarity explains.
  double camera_background = 0;
  /// Keep only what moves by itself, or appears (IndependentMotion).
  bool camera_gate = false;
  /// Habituation: what has stood still for this long is no longer new, in frames at 30 fps. It
  /// fades from the map within another 9 frames. Only while the camera rests. Infinity: never.
  double habituation_after = std::numeric_limits<double>::infinity();
  /// A sample stands still while its spatial saliency stays within this of what it was at first, or
  /// within this share of it.
  double habituation_contrast = 0.6;
  double habituation_share = 0.2;
  /// Gradual transitions (dissolves, fades, changes of exposure) are no events.
  bool transition_guard = false;
  /// Reduce the map by this gain times its noise floor (NoiseFloor). 0: off.
  double noise_gain = 0;
  /// Background subtraction: what happens all over the map is no event. The spatiotemporal map is
  /// reduced by this gain times its background_quantile. 0: off.
  double background_gain = 0;
  double background_quantile = 0.75; ///< in [0, 1]
  /// Upper limit of that reduction, in the map's units: very salient content stays an event even if
  /// it is large.
  double background_limit = std::numeric_limits<double>::infinity();
  /// A new shot begins, with an empty history, if more than this share of the pixels change by more
  /// than `cut_contrast` from one frame to the next. 1: never.
  double cut_share = 1;
  double cut_contrast = 6; ///< ΔE
  /// Applied to the spatiotemporal saliency map.
  Normalization temporal_normalization = Normalization::none;

  /// The paper to the letter where it is explicit: c ∈ {2,3,4}, δ ∈ {3,4}, N(·), absolute temporal
  /// differences of levels c ∈ {0,1,2}, s = c + {3,4}, L*a*b* per pixel.
  static Profile paper();

  /// The best profile measured on films (docs/measured/quality.md has the figures): one pair c = 2,
  /// δ = 1, chroma × 2, no N(·), pooled to level 4, onsets only, windows 1/8, 2/16, 4/32, 8/64.
  /// Shot cuts, changes of light, camera motion, what stands still and what goes on all the time
  /// are discounted.
  static Profile tuned();

  /// The best profile measured on single pictures, for analysis without `temporal`: surroundedness
  /// at level 3 times color rarity, no shot cuts, no camera motion. Otherwise as tuned().
  static Profile tuned_spatial();
};

/// Why `profile` is invalid; empty if it is valid.
std::string_view fault_of(const Profile &profile);

} // namespace saliency
