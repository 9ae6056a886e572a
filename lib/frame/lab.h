// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/frame_view.h"
#include "frame/image_rows.h"

#include <array>
#include <cstdint>
#include <string_view>

namespace saliency {

/// How code values stand for color.
struct SampleCoding
{
  ColorModel model = ColorModel::yuv;
  int depth = 8;           ///< bits of a sample: 8…16
  bool full_range = false; ///< gray and yuv; R'G'B' always uses all codes
  YuvMatrix matrix = kBt709;
};

/// Why that is no coding; empty if it is one.
std::string_view fault_of(const SampleCoding &coding);

/// Component samples → CIE 1976 L*a*b* (paper, Section 3: "using CIE L*a*b* color space") in true
/// units: L* in [0, 100], a* and b* in about [-108, 99]. White is D65.
///
/// Samples become R'G'B' as in ITU-R BT.601/709/2020 (codes 16–235/240 × 2^(depth-8), or all of
/// them) and are clipped to [0, 1]; R'G'B' becomes light by the sRGB curve (IEC 61966-2-1), light
/// becomes XYZ by BT.709's primaries. Signals have 15 bits, the curves' powers are polynomials: ΔE
/// to the exact value stays below 0.06, a tenth of what a code of 8 bits makes, and white is 100,
/// 0, 0. The result is the same on every processor.
class LabConverter
{
public:
  /// Of a coding that is possible.
  explicit LabConverter(const SampleCoding &coding = {});

  /// `components`: rows of Y', Cb, Cr or R', G', B' or gray alone, in code values times 2^(15 -
  /// depth). `lab`: rows of L*, a*, b* as in a FixedLabImage. Reads and writes up to 32 samples
  /// beyond `count`, as a RowBuffer allows.
  void convert(const std::array<const Fixed *, 3> &components, int count,
               const std::array<Fixed *, 3> &lab) const;

  static constexpr int kNoChroma = 128 * 128; ///< sample

  /// Weights in units of 2⁻¹⁵. Y'CbCr and gray: luma less luma_zero times luma_scale is a signal in
  /// units of 2⁻¹⁴, to which twice the chroma samples less kNoChroma are added, weighed. R'G'B':
  /// what is added to a sample for a signal in units of 1/32767, times the sample.
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
