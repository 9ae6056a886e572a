// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/frame_view.h"
#include "frame/image_rows.h"

#include <array>
#include <cstdint>
#include <string_view>

namespace saliency {

/// How code values represent color.
struct SampleCoding
{
  ColorModel model = ColorModel::yuv;
  int depth = 8;           ///< bits of a sample: 8…16
  bool full_range = false; ///< gray and yuv; R'G'B' always uses all codes
  YuvMatrix matrix = kBt709;
};

/// Why `coding` is invalid; empty if it is valid.
std::string_view fault_of(const SampleCoding &coding);

/// Component samples → CIE 1976 L*a*b* (paper, Section 3: "using CIE L*a*b* color space"): L* in
/// [0, 100], a* and b* in about [-108, 99]. White is D65.
///
/// Samples become R'G'B' as in ITU-R BT.601/709/2020 (codes 16–235/240 × 2^(depth-8), or full
/// range), clipped to [0, 1]. R'G'B' is linearized by the sRGB curve (IEC 61966-2-1) and becomes
/// XYZ by BT.709's primaries.
///
/// Signals have 15 bits and powers are polynomials. ΔE to the exact value stays below 0.06, a tenth
/// of the quantization error of 8-bit codes; white is exactly (100, 0, 0). The result is the same
/// on every CPU.
class LabConverter
{
public:
  /// Requires an empty fault_of(coding).
  explicit LabConverter(const SampleCoding &coding = {});

  /// Converts `count` samples. `components`: rows of Y', Cb, Cr or R', G', B' or gray alone, in
  /// code values times 2^(15 - depth). `lab`: rows of L*, a*, b* as in a FixedLabImage. Reads and
  /// writes up to 32 samples beyond `count`, as a RowBuffer allows.
  void convert(const std::array<const Fixed *, 3> &components, int count,
               const std::array<Fixed *, 3> &lab) const;

  static constexpr int kNoChroma = 128 * 128; ///< a neutral chroma sample

  /// Weights in units of 2⁻¹⁵. Y'CbCr and gray: (luma - luma_zero) · luma_scale is a signal in
  /// units of 2⁻¹⁴; to it is added 2 · (chroma - kNoChroma) times the chroma weight. R'G'B':
  /// luma_scale times a sample is added to the sample to give a signal in units of 1/32767.
  struct Coefficients
  {
    std::int16_t luma_zero = 0;
    std::int16_t luma_scale;
    std::int16_t r_cr = 0;
    std::int16_t g_cb = 0;
    std::int16_t g_cr = 0;
    std::int16_t b_cb = 0;
  };

private:
  ColorModel model_;
  Coefficients coefficients_;
};

} // namespace saliency
