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

/// What makes a place stand out in a single picture.
enum class SpatialCue
{
  contrast,       ///< ΔE to its surround, a coarser level of the pyramid
  surroundedness, ///< being enclosed by another color (see Surroundedness)
};

/// The operator N(·) of Itti & Koch, or none.
enum class Normalization
{
  none,
  itti, ///< scale to [0, 1], multiply by (1 − m̄)²
};

/// Which temporal differences count.
enum class TemporalSign
{
  absolute, ///< |center − surround|: also what went away (a ghost for up to 64 frames)
  onset,    ///< max(0, center − surround): only what came
};

/// What a temporal window counts.
enum class TimeBase
{
  frames,  ///< frames, whatever their duration
  seconds, ///< frames / 30 s, whatever the frame rate
};

/// What the history holds before the first frame.
enum class HistoryStart
{
  empty,  ///< nothing: windows are the mean of what there is
  filled, ///< the first map, as if it had always been there: no burst after start, seek or cut
};

/// Of so few samples one thing may be most: in smaller maps nothing is said of what the whole
/// picture does: that a shot begins (Profile::cut_share), that the light changes
/// (illumination_guard), that something happens everywhere (background_gain).
inline constexpr int kFewestSamples = 64;

/// Every choice between the frame and its saliency map (docs/design/algorithm.md). Valid if there are
/// level pairs with 0 ≤ center ≤ surround and window pairs of at least 1, no number is negative or
/// NaN, the quantile is in [0, 1], and the camera is followed in seconds only.
struct Profile
{
  /// L*a*b* of every pixel before decimation, of large frames, too (conversion_level()).
  bool exact = false;
  /// 0: pyramid levels are the frame's own. Else they are renumbered so that level 2 is the level
  /// whose larger side is nearest to this in octaves, as far as none falls below 0.
  int reference_width = 0;
  /// w in ΔE = √(ΔL² + w² (Δa² + Δb²)).
  double chroma_weight = 1;
  /// By so many levels the chroma's pairs are coarser than the lightness': the eye sees color less
  /// sharply, and films hold it at half the resolution, hence with more noise.
  int chroma_octaves = 0;
  SpatialCue spatial_cue = SpatialCue::contrast;
  /// Of the spatial contrast maps; each is limited to the levels that the frame has.
  /// Surroundedness is taken at the center's level alone.
  std::vector<LevelPair> levels;
  /// ΔE between the thresholds of surroundedness, 0.5 to 100.
  double threshold_step = 3;
  /// p of surroundedness: a region counts (1 % of the picture / its area)^p, 0 to 1.
  double area_exponent = 0.5;
  /// Of each contrast map, before they are combined.
  Normalization contrast_normalization = Normalization::none;
  /// Mean of the contrast maps rather than their sum.
  bool contrast_mean = false;
  /// Level of the spatial saliency map; contrast maps are brought to it grid-correctly.
  int saliency_level = 2;
  /// The spatial saliency map is multiplied by color rarity, taken at the coarsest of the pairs'
  /// levels.
  bool rarity = false;
  /// Of the temporal contrast maps.
  std::vector<WindowPair> windows;
  TemporalSign temporal_sign = TemporalSign::absolute;
  /// Mean of the temporal contrast maps rather than their sum.
  bool temporal_mean = false;
  TimeBase time_base = TimeBase::seconds;
  HistoryStart history_start = HistoryStart::filled;
  /// Illumination guard: if most of what has contrast gains it by one factor β, then the light has
  /// changed and not what is to be seen. Surrounds count β times.
  bool illumination_guard = false;
  /// Camera motion (windows in seconds only): it is followed, and the history moved with it. As
  /// long as the history holds a motion, the following three count as well.
  bool camera_motion = false;
  /// Surrounds are dilated by so many samples: motion is not followed exactly, nor is it a
  /// similarity everywhere.
  int camera_dilation = 0;
  /// Surrounds count so many times: contrast depends a little on where samples fall.
  double camera_margin = 1;
  /// So wide a rim of the map is silent, in samples: there the picture comes in. A map of at most
  /// twice that has none.
  int camera_rim = 0;
  /// What happens all over the map is no event: so many times the map's quantile below is taken off
  /// the spatiotemporal map. 0: nothing is.
  double background_gain = 0;
  double background_quantile = 0.75; ///< in [0, 1]
  /// No more than this is taken off, in the map's units: what is very salient is an event even if
  /// it is large.
  double background_limit = std::numeric_limits<double>::infinity();
  /// A new shot begins, with no history, where more than this share of the picture's pixels change
  /// by more than `cut_contrast` from one frame to the next. 1: never.
  double cut_share = 1;
  double cut_contrast = 6; ///< ΔE
  /// Of the spatiotemporal saliency map.
  Normalization temporal_normalization = Normalization::none;

  /// The paper taken literally where it is explicit: c ∈ {2,3,4}, δ ∈ {3,4}, N(·), absolute
  /// temporal differences of levels c ∈ {0,1,2}, s = c + {3,4}, per-pixel L*a*b*.
  static Profile paper();

  /// What measures best on films (docs/design/algorithm.md has the figure behind each choice): one pair c
  /// = 2, δ = 1, chroma × 2, no N(·), pooled to level 4, onsets only, windows 1/8, 2/16, 4/32,
  /// 8/64; shots, changes of light, what happens everywhere and the camera's motion are told from
  /// events.
  static Profile tuned();

  /// What measures best on single pictures, that is without `temporal`: surroundedness at level 3
  /// times color rarity; neither cuts nor camera. Otherwise as tuned().
  static Profile tuned_spatial();
};

/// Why nothing can be analyzed so; empty if it can.
std::string_view fault_of(const Profile &profile);

} // namespace saliency
