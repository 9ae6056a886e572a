// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/pyramid.h"
#include "saliency/sampling.h"
#include "saliency/similarity.h"

#include <opencv2/core/mat.hpp>

#include <array>
#include <vector>

namespace saliency {

/// What the camera does as it pans, tilts, zooms, rolls or shakes, as one similarity from frame to
/// frame.
///
/// Frames are registered with a key frame up to 8/30 s back, on lightness, coarse to fine:
/// Gauss-Newton steps that compare the frame with the key frame's most textured points, weighted so
/// that what goes its own way does not count, allowing for another exposure (inverse compositional
/// alignment: Baker & Matthews, "Lucas-Kanade 20 Years On", 2004). The camera counts as moving only
/// if that explains the difference in most of those parts of the picture that would show it, and if
/// there are enough of these: what moves in front of a still background is not the camera, nor what
/// moves in front of an even one if it is narrower than about a fifth of the picture (two things: a
/// tenth each). Pictures of less than about 30 × 20 samples have no camera.
class CameraMotion
{
public:
  /// The next frame, `elapsed` frames at 30 fps after the last one: its L*, CV_32FC1 and
  /// continuous, at a pyramid level about 100 samples wide. Returns the camera's pose, that is
  /// where this frame's samples lie in the first frame; exactly the last pose again while the
  /// camera rests, from the first key frame at rest on. The first frame after a reset, and one of
  /// another size, is a first frame.
  const Similarity &follow(const cv::Mat &lightness, double elapsed);

  /// Whether the last frame shows what went before, from elsewhere.
  bool moved() const
  {
    return moved_;
  }

  void reset();

  /// Makes the last frame the one in which poses are: from far away, or zoomed far, they could not
  /// be told exactly.
  void rebase();

private:
  static constexpr std::size_t kLevels = 3;

  using Images = std::array<cv::Mat, kLevels>; ///< lightness, CV_32FC1, finest first

  void set_key();
  /// What leads from the key frame to this one.
  struct Change
  {
    Similarity motion;                ///< in samples of the level at hand
    std::array<double, 2> exposure{}; ///< gain and offset
  };

  Change fit(std::size_t level, Change change, bool at_rest);
  void find_residuals(std::size_t level, const Change &change, std::vector<float> &residuals) const;
  bool explained();

  Images now_;
  std::array<Reduction, kLevels> reductions_;  ///< to each level
  std::array<TexturedPoints, kLevels> points_; ///< of the key frame
  cv::Size size_;                              ///< of the key frame; empty: none
  double age_ = 0;                             ///< of the key frame, in frames
  Similarity key_pose_;                        ///< of the key frame
  Change change_;
  Similarity pose_;
  bool moved_ = false;           ///< since the key frame
  std::vector<float> residuals_; ///< of the points of a level
  std::vector<float> without_;   ///< if the camera rests
  std::vector<float> opposite_;  ///< if it makes the opposite motion
  std::vector<float> sizes_;     ///< of residuals
};

} // namespace saliency
