// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/lab_image.h"
#include "saliency/similarity.h"

#include <opencv2/core/mat.hpp>

#include <array>
#include <vector>

namespace saliency {

/// The part of the change between two pictures that neither the camera, nor a change of exposure,
/// nor noise explains.
///
/// The difference is compared with a model of its noise, whose two terms are measured in the
/// pictures: the noise of even parts, and the misfit of texture (errors of the camera's motion,
/// depth, moving texture), which grows with the gradient. Therefore nothing has to decide whether
/// the camera moves.
class Unexplained
{
public:
  /// Compares `now` with `then`, at a level about 100 samples wide, continuous and of one size.
  /// `before` maps samples of `now` to samples of `then`.
  ///
  /// Returns the part of ΔE above the noise (CV_32FC1, ≥ 0); 0 outside of `then`.
  const cv::Mat &operator()(const LabImage &now, const LabImage &then, const Similarity &before);

  /// The shares of lightness in it that rise and fall: their sum is the whole where no color
  /// changes. `now` is the last call's.
  void split(const LabImage &now, cv::Mat &brighter, cv::Mat &darker) const;

  /// The difference at textured places in the last pictures, in samples of displacement: about .03
  /// with a hand-held camera, .2 with one that travels.
  float misfit() const
  {
    return misfit_;
  }

private:
  void align(const LabImage &then, const Similarity &before);
  void find_exposure(const cv::Mat &now);
  void find_gradients(const cv::Mat &now);
  bool has_texture();

  std::array<cv::Mat, 3> warped_;
  std::array<cv::Mat, 3> then_; ///< aligned with now: warped or not; NaN outside
  std::vector<double> columns_; ///< sums of a row of blocks: now, then, count
  float gain_ = 1;
  float offset_ = 0;
  cv::Mat gradients_; ///< the larger of both pictures'
  cv::Mat along_rows_;
  cv::Mat around_; ///< the largest gradient around a sample
  cv::Mat difference_;
  std::vector<float> even_;
  std::vector<float> textured_;
  std::vector<float> counts_; ///< of textured samples, by column
  float misfit_ = 0;
  cv::Mat beyond_;
};

} // namespace saliency
