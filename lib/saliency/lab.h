// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/frame_view.h"

#include <array>

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
/// becomes XYZ by BT.709's primaries. The curves' powers are polynomials: ΔE to the exact value
/// stays below 0.025, and white is 100, 0, 0. The result is the same on every processor.
class LabConverter
{
public:
  /// Throws std::invalid_argument if the coding is impossible.
  explicit LabConverter(const SampleCoding &coding = {});

  /// `components`: rows of Y', Cb, Cr or R', G', B' or grey alone, in code values (fractions are
  /// welcome: means of samples). `lab`: rows of L*, a*, b*. Reads and writes up to 16 samples beyond
  /// `count`, as a RowBuffer allows.
  void convert(const std::array<const float *, 3> &components, int count,
               const std::array<float *, 3> &lab) const;

  /// Code values → signal: (code - zero) · scale, 0…1 for R', G', B', Y' and -½…½ for Cb, Cr; and
  /// Y'CbCr → R'G'B'.
  struct Coefficients
  {
    float luma_zero;
    float luma_scale;
    float chroma_zero;
    float chroma_scale;
    float r_cr;
    float g_cb;
    float g_cr;
    float b_cb;
  };

private:
  ColorModel model_;
  Coefficients coefficients_;
};

} // namespace saliency
