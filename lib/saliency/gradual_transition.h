// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/lab_image.h"

#include <opencv2/core/mat.hpp>

#include <cstddef>
#include <vector>

namespace saliency {

/// Detector of gradual transitions: dissolves, fades to and from black, changes of exposure. In
/// each of them every sample goes on changing as it did, at one common pace, and most samples
/// change. A moving object changes samples one after the other.
///
/// With D1 = I(t) − I(t − k) and D2 = I(t − k) − I(t − 2k), k = 4/30 s and γ = ⟨D1, D2⟩/⟨D2, D2⟩,
/// a transition is one in which D1 ≈ γ D2 at most of the samples that change.
class GradualTransition
{
public:
  /// Adds the next frame, `elapsed` frames at 30 fps after the last one: its L*a*b* at the level of
  /// the saliency map, which is copied.
  ///
  /// Returns which samples change as the transition does, or do not change (CV_32FC1, 1 or 0);
  /// empty if there is none, nor was within the last 6/30 s.
  const cv::Mat &operator()(const LabImage &lab, double elapsed);

  /// Drops the past.
  void reset();

private:
  struct Picture
  {
    double age = 0; ///< in frames
    LabImage lab;
  };

  const Picture &shown(double age) const;

  std::vector<Picture> past_; ///< a ring
  std::size_t count_ = 0;
  std::size_t latest_ = 0;
  double since_ = 0; ///< the last transition, in frames
  cv::Mat mask_;
  cv::Mat none_;
};

} // namespace saliency
