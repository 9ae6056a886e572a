// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/frame_view.h"
#include "frame/lab_image.h"
#include "nanoseconds.h"
#include "saliency/profile.h"
#include "saliency/similarity.h"

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include <functional>
#include <memory>

namespace saliency {

/// Saliency of one frame. `map` is valid until the next call on the same analyzer and must not be
/// modified.
struct Saliency
{
  /// CV_32FC1 of the size of level frame_levels().saliency, finite and ≥ 0. In ΔE; with
  /// Method::paper in the units of N(·).
  cv::Mat map;
  double peak = 0; ///< maximum of `map`
  /// The strength of the events, ≥ 0, relative to the film's last minutes (Strength). 0 with
  /// Method::paper.
  double strength = 0;
  /// The picture's rectangle in the map, where sample i covers [i, i + 1). Sample i of level n is
  /// centered on pixel 2ⁿ·i, so the picture's edges are not the map's.
  cv::Rect2d picture;
  bool cut = false;          ///< this frame starts a new shot
  bool unchanged = false;    ///< the frame shows nothing new, and was not analyzed (set_rest)
  bool camera_moves = false; ///< since up to 8/30 s ago
  /// The camera's motion: maps samples of the last frame's map to samples of `map`.
  Similarity motion;
};

/// How often a frame may be halved ([1 4 6 4 1]/16, even samples kept) before its analysis without
/// another change of the map than rounding: as often as the front end halves its components. 0 with
/// Profile::exact, whose L*a*b* is that of every pixel.
int preceding_halvings(const Profile &profile, cv::Size frame);

/// The steps of an analysis, in order. Without history: lab, pyramid, spatial.
enum class Stage
{
  lab, ///< the front end
  pyramid,
  camera,
  shot_cut,
  spatial,
  history, ///< with Method::paper a part of the next stage
  spatiotemporal,
};

/// Frame → L*a*b* pyramid → saliency map, by the profile's method: Paper, or SpatialSaliency and
/// EventMap. Not thread-safe: use one analyzer per stream, from one thread at a time.
class Analyzer
{
public:
  /// Requires an empty fault_of(profile).
  explicit Analyzer(const Profile &profile);
  ~Analyzer();
  Analyzer(Analyzer &&) noexcept;
  Analyzer &operator=(Analyzer &&) noexcept;

  /// Analyzes the frame shown during [time, time + duration). Requires an empty fault_of(frame). A
  /// duration ≤ 0 is taken as 1/30 s.
  ///
  /// The history is reset first if `time` is not after the last frame's, or if the size differs.
  /// Unless the method is the paper's, it is also reset after a gap of more than two seconds.
  ///
  /// If `temporal` is false, the result is the spatial saliency alone, and the next frame starts a
  /// new history.
  const Saliency &analyze(const FrameView &frame, Time time, Time duration, bool temporal = true);

  /// Analyzes an L*a*b* image of level frame_levels(profile(), frame).finest, without a front end.
  /// `frame` is the size of the frame that it is of.
  const Saliency &analyze(const LabImage &lab, cv::Size frame, Time time, Time duration,
                          bool temporal = true);

  /// The last frame's L*a*b* at the finest level in use, valid until the next call. For films it
  /// may have no a* and b*.
  const LabImage &picture() const;

  /// Calls `observer` after each stage, with the stage's map or an empty one. For measurements.
  void set_observer(std::function<void(Stage, const cv::Mat &map)> observer);

  /// Lets frames pass without an analysis, up to four in a row at 30 fps, that show the same as
  /// the last analyzed one (Stillness), while the map is silent. The first frame that differs, by
  /// a share of `floor`, is analyzed. With 0, initially, and with other methods
  /// than Method::events, all are.
  void set_rest(double floor);

  /// Drops the history. The next frame fills it with its own spatial map, so there is no burst
  /// after start, seek or cut.
  void reset();

  /// Sets the maximum number of threads per frame; initially 1. With 0 or less, it is 1.
  /// The result is the same for any number, and the history is kept.
  void set_threads(int threads);

  const Profile &profile() const;

private:
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace saliency
