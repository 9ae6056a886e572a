// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/pyramid.h"
#include "saliency/sampling.h"
#include "saliency/similarity.h"

#include <opencv2/core/mat.hpp>

#include <array>
#include <vector>

namespace saliency {

/// Global camera motion (pan, tilt, zoom, roll, shake) as one similarity per frame.
///
/// Frames are registered with a key frame up to 8/30 s back, on lightness and from coarse to fine.
/// Each Gauss-Newton step compares the most textured points of the key frame (inverse compositional
/// alignment: Baker & Matthews, "Lucas-Kanade 20 Years On", 2004). Robust weights suppress objects
/// that move independently; gain and offset absorb a change of exposure.
///
/// The camera counts as moving only if the motion explains the difference in most parts of the
/// picture that would show it. A part may have a shift of its own beyond it, as near and far things
/// have when a camera travels. There must be enough such parts. An object that moves over a still
/// background therefore does not count. Over a plain background it does not count if it is narrower
/// than about a fifth of the picture (two objects: a tenth each). Pictures smaller than about 30 ×
/// 20 samples never have camera motion.
class CameraMotion
{
public:
  /// Adds the next frame, `elapsed` frames at 30 fps after the last one. `lightness`: its L*,
  /// CV_32FC1 and continuous, at a pyramid level about 100 samples wide.
  ///
  /// Returns the camera's pose: the map from this frame's samples to those of the first frame.
  /// While the camera rests, the pose stays bit-identical, starting with the first key frame at
  /// rest. The first frame after reset() and one of another size start anew, with the identity.
  const Similarity &follow(const cv::Mat &lightness, double elapsed);

  /// A frame that shows the same as the last one, before a camera at rest.
  void stay(double elapsed);

  /// Whether the camera moved between the key frame and the last frame.
  bool moved() const
  {
    return moved_;
  }

  /// Drops the key frame and the pose: the next frame is a first one.
  void reset();

  /// Makes the last frame the reference of all poses: far from the reference they lose precision.
  void rebase();

private:
  static constexpr std::size_t kLevels = 3;

  using Images = std::array<cv::Mat, kLevels>; ///< lightness, CV_32FC1, finest first

  void set_key();
  /// The change from the key frame to this frame.
  struct Change
  {
    Similarity motion;                ///< in samples of the current level
    std::array<double, 2> exposure{}; ///< gain and offset
  };

  Change fit(std::size_t level, Change change, bool at_rest);
  void find_residuals(std::size_t level, const Change &change, std::vector<float> &residuals) const;
  /// The vote of a part of the picture.
  enum class Vote
  {
    none, ///< nothing to see there, or the motion is too small
    moved,
    rested, ///< rested, or moved in another way
  };
  cv::Point2d fit_part(std::size_t part);
  Vote vote(std::size_t part, cv::Point2d shift) const;
  bool explained();

  Images now_;
  std::array<Reduction, kLevels> reductions_;  ///< to each level
  std::array<TexturedPoints, kLevels> points_; ///< of the key frame
  std::vector<std::size_t> part_of_; ///< part of the picture, by point of the finest level
  cv::Size size_;                    ///< of the key frame; empty if there is none
  double age_ = 0;                   ///< of the key frame, in frames
  Similarity key_pose_;              ///< of the key frame
  Change change_;
  Similarity pose_;
  bool moved_ = false;           ///< since the key frame
  std::vector<float> residuals_; ///< at the points of a level
  std::vector<float> without_;   ///< residuals for a camera at rest
  std::vector<float> opposite_;  ///< residuals for the opposite motion
  std::vector<float> sizes_;     ///< absolute residuals
  TexturedPoints part_points_;
  std::vector<float> part_residuals_;
};

} // namespace saliency
