// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/ahead.h"
#include "saliency/image_rows.h"

#include <array>
#include <cstddef>
#include <cstdint>

/// How rows of samples are decimated, and brought to twice their width where chroma has too few, for the
/// widest vectors that this CPU has (Highway); the result is the same on all of them. No sample before a
/// row's first or after its last is read or written.
namespace saliency::kernels {

/// How many rows of half the height are made at once: sums are read and written once for all of them.
constexpr int kAtOnce = 2;
template <typename T> using AtOnce = std::array<T, kAtOnce>;

/// Rows 2y + 1 and 2y + 2 of an image, and those that follow, two for each row that is made.
constexpr std::ptrdiff_t kSourceRows = std::ptrdiff_t{ 2 } * kAtOnce;
using SourceRows = std::array<const std::uint8_t *, kSourceRows>;

/// Of rows of bytes, each halved from side to side times 16 (h): h[2y - 2] + 4 h[2y - 1] + 6 h[2y], and
/// h[2y].
struct RowSums
{
  std::uint16_t *weighted;
  std::uint16_t *last;
};

/// Every other sample of [1 4 6 4 1]/16 along both axes, mirrored at a row's ends without repeating
/// them: from rows of `width` bytes and the sums of those before them, rows y, y + 1, … of half the
/// height, rounded half up to code values times 128, and the sums for the next.
void halve_bytes(const SourceRows &rows, int width, const RowSums &sums,
                 const AtOnce<Fixed *> &halved, const Ahead &ahead);

/// The same of pixels of four bytes, the first three of which go to rows of their own; there are four sums
/// a pixel, and the last byte of a row need not be there.
void halve_pixels(const SourceRows &rows, int width, const RowSums &sums,
                  const AtOnce<std::array<Fixed *, 3>> &halved, const Ahead &ahead);

/// Every other sample of [1 4 6 4 1]/16 along a row, likewise; of Fixed rounded down.
void halve_columns(const Fixed *row, int width, Fixed *halved);
void halve_columns(const float *row, int width, float *halved);

/// [1 4 6 4 1]/16 over five rows; of Fixed by means of two, each rounded half up.
void halve_rows(const std::array<const Fixed *, 5> &rows, int count, Fixed *halved);
void halve_rows(const std::array<const float *, 5> &rows, int count, float *halved);

/// `width` samples, at every other place those of `in` and between them their means, rounded half up;
/// the last is repeated where it is followed by one more.
void double_columns(const Fixed *in, int width, Fixed *out);

/// The means of two rows, rounded half up.
void average(const Fixed *a, const Fixed *b, int count, Fixed *out);

} // namespace saliency::kernels
