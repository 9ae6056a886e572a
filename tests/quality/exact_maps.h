// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/frame_view.h"
#include "saliency/profile.h"
#include "saliency/spatial_saliency.h"

#include <opencv2/core/mat.hpp>

namespace quality {

// Spatial saliency in double precision, by the definitions of tests/check/libs/saliency_oracle.h
// but fast enough for films. Frames are of 8 bits, with as much chroma as lightness, or half of it.

/// L*a*b* of every pixel, CV_64FC3; chroma is interpolated linearly, sample i on pixel 2ᵏ·i.
/// `threads` ≥ 1 share the rows.
cv::Mat exact_lab(const saliency::FrameView &frame, int threads);

/// [1 4 6 4 1]/16 and every second sample, `octaves` times.
cv::Mat decimated(cv::Mat image, int octaves);

/// S of a profile whose cue is contrast and which has no N(·), of the L*a*b* image at
/// `levels.finest` (CV_64FC3). CV_64FC1 at `levels.saliency`.
cv::Mat exact_spatial_saliency(const cv::Mat &lab, const saliency::FrameLevels &levels,
                               const saliency::Profile &profile);

} // namespace quality
