// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace saliency {

/// The meaning of a frame's components.
enum class ColorModel
{
  gray, ///< one component, gray R'G'B'
  yuv,  ///< Y', Cb, Cr
  rgb,  ///< R', G', B'
};

/// Luma coefficients of a Y'CbCr signal: Y' = kr R' + (1 - kr - kb) G' + kb B'.
struct YuvMatrix
{
  double kr;
  double kb;
};
inline constexpr YuvMatrix kBt601{ 0.299, 0.114 };    ///< ITU-R BT.601
inline constexpr YuvMatrix kBt709{ 0.2126, 0.0722 };  ///< ITU-R BT.709
inline constexpr YuvMatrix kBt2020{ 0.2627, 0.0593 }; ///< ITU-R BT.2020, non-constant luminance

/// One component of a frame in memory: sample (x, y) is at
/// `data + y * row_stride + x * pixel_stride`. Strides are in bytes; row_stride may be negative.
struct Component
{
  const std::uint8_t *data = nullptr;
  std::ptrdiff_t row_stride = 0;
  int pixel_stride = 1;
  int width = 0;  ///< samples: ⌈frame width / 2ᵏ⌉ for some k ≥ 0
  int height = 0; ///< samples: ⌈frame height / 2ᵏ⌉ for some k ≥ 0
};

/// A frame in memory, not owned; planar, semi-planar and packed layouts alike. 8-bit samples are
/// bytes. Deeper samples are 16-bit little-endian words whose value is
/// `(word >> shift) & ((1 << depth) - 1)`: I420_10LE has shift 0, P010_10LE shift 6.
struct FrameView
{
  int width = 0;  ///< pixels, at least 1
  int height = 0; ///< pixels, at least 1
  ColorModel model = ColorModel::yuv;
  int depth = 8; ///< significant bits of a sample: 8…16
  int shift = 0; ///< position of the lowest significant bit in the word; 0 for bytes
  /// Full range ("pc"), rather than codes 16–235/240 ("tv"); for gray and yuv only.
  bool full_range = false;
  YuvMatrix matrix = kBt709;
  std::array<Component, 3> components{}; ///< Y, Cb, Cr or R, G, B or gray alone
};

} // namespace saliency
