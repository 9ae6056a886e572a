// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/frame_view.h"

#include <opencv2/core/mat.hpp>

#include <span>
#include <vector>

namespace saliency {

/// How code values stand for colour.
struct SampleCoding
{
  ColorModel model = ColorModel::yuv;
  int depth = 8;           ///< bits of a sample: 8…16
  bool full_range = false; ///< grey and yuv; R'G'B' always uses all codes
  YuvMatrix matrix = kBt709;
};

/// Component samples → CIE 1976 L*a*b* (paper, Section 3: "using CIE L*a*b* color space") in true
/// units: L* in [0, 100], a* and b* in about [-108, 99]. White is D65.
///
/// Samples become R'G'B' as in ITU-R BT.601/709/2020 (codes 16–235/240 × 2^(depth-8), or all of
/// them) and are clipped to [0, 1]; R'G'B' becomes light by the sRGB curve (IEC 61966-2-1), light
/// becomes XYZ by BT.709's primaries. The two curves are read from tables with linear
/// interpolation: ΔE to the exact value stays below 0.01.
class LabConverter
{
public:
  LabConverter();

  /// `components`: Y', Cb, Cr or R', G', B' or grey alone, CV_32FC1 of one size, in code values
  /// (fractions are welcome: means of samples). `lab` becomes CV_32FC3 of that size. Throws
  /// std::invalid_argument if the coding is impossible.
  void convert(const SampleCoding &coding, std::span<const cv::Mat> components, cv::Mat &lab) const;

private:
  float light(float signal) const;
  float lightness(float light) const;

  std::vector<float> light_;     ///< sRGB signal in [0, 1] → light
  std::vector<float> lightness_; ///< light relative to white's, in [0, 1] → CIE's f(t)
};

} // namespace saliency
