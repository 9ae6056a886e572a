// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/frame_view.h"
#include "saliency/lab.h"

#include <opencv2/core/mat.hpp>

#include <array>
#include <vector>

namespace saliency {

/// Frame → L*a*b* image at one level of the pyramid: the only part that reads a frame's memory.
///
/// `exact` computes L*a*b* of every pixel, then the pyramid, as the paper does. Otherwise the
/// components are decimated first, each from its own resolution, and L*a*b* is computed on what is
/// left: at two levels a sixteenth of the work for a mean ΔE of 0.64 (the conversion is not linear;
/// 8-bit planes are rounded at each level).
///
/// Subsampled chroma is taken to lie on the pyramid's grid, sample i at pixel 2ᵏ·i, which is where
/// MPEG-2, H.264 and later put it horizontally; vertically it is half a pixel off.
class FrontEnd
{
public:
  explicit FrontEnd(bool exact);

  /// The frame's CV_32FC3 L*a*b* image at `level`, valid until the next call. A component's width
  /// must be ⌈frame width / 2ᵏ⌉ for some k ≥ 0, likewise its height; the first component has the
  /// frame's size. Throws std::invalid_argument for a frame that cannot be one: no size, no data,
  /// impossible depth or strides.
  const cv::Mat &lab(const FrameView &frame, int level);

private:
  /// Buffers of one component, kept from frame to frame.
  struct Plane
  {
    cv::Mat samples; ///< unpacked to CV_8UC1 or CV_16UC1 where they do not lie like that already
    std::vector<cv::Mat> reduced;       ///< in the samples' own depth
    std::array<cv::Mat, 2> single_axis; ///< further reduced along one axis, CV_32FC1
    cv::Mat values;                     ///< CV_32FC1
    cv::Mat upsampled;
  };

  static cv::Mat at_level(const FrameView &frame, const Component &component, int level,
                          Plane &plane);

  bool exact_;
  LabConverter converter_;
  std::array<Plane, 3> planes_;
  std::vector<cv::Mat> lab_; ///< at level 0…`level` when exact, else one
};

} // namespace saliency
