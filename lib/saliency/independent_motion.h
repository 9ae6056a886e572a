// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/lab_image.h"
#include "saliency/pyramid.h"
#include "saliency/sampling.h"
#include "saliency/similarity.h"

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include <array>
#include <vector>

namespace saliency {

/// What moves by itself while the camera travels.
///
/// A camera that travels shifts near things more than far ones (parallax), which no similarity
/// explains. Here a mesh of local motions does: on top of the camera's similarity each node is
/// registered with a key frame some frames back, and a median over neighboring nodes removes
/// objects. What the mesh leaves of the difference, relative to the gradient, moves by itself or
/// has appeared. Where near things pass everywhere, only what stands out of them counts.
class IndependentMotion
{
public:
  /// Adds the next frame, `elapsed` frames at 30 fps after the last one. `lab`: its
  /// L*a*b* at a pyramid level about 100 samples wide, continuous. `pose`: the camera's, in samples
  /// of that level (CameraMotion::follow).
  ///
  /// Returns by how much each sample of the level coarser by `octaves` moves by itself, in [0, 1]
  /// (CV_32FC1). It begins open, for what happened before, and holds for about 1/4 s.
  const cv::Mat &operator()(const LabImage &lab, const Similarity &pose, double elapsed,
                            int octaves);

  /// Drops the key frame.
  void reset();

private:
  static constexpr int kColumns = 12;
  static constexpr int kRows = 9;
  struct Node
  {
    cv::Point2f motion; ///< beyond the camera's
    bool known = false;
  };
  using Mesh = std::array<Node, static_cast<std::size_t>(kColumns *kRows)>;

  void set_key(const LabImage &now, const Similarity &pose);
  void fit(const cv::Mat &now, const Similarity &motion);
  void smooth();
  void widen(int width);
  void find_novelty(const LabImage &now, const Similarity &motion);

  bool has_key_ = false;
  LabImage key_;
  Similarity key_pose_;
  double age_ = 0; ///< of the key frame, in frames
  std::array<TexturedPoints, static_cast<std::size_t>(kColumns *kRows)>
      points_; ///< of the key frame
  Mesh mesh_;
  Mesh smooth_; ///< per frame
  std::vector<float>
      wide_;        ///< smooth_ at each column of the picture since the key frame: x, then y
  cv::Mat novelty_; ///< residual / gradient
  std::array<Reduction, 3> reductions_;
  std::array<cv::Mat, 3> pooled_;
  cv::Mat held_;
  float before_ = 0; ///< novelty that stands for what happened before the first frame
  std::vector<float> sorted_;
  cv::Mat gate_;
};

} // namespace saliency
