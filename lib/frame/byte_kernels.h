// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/ahead.h"
#include "frame/image_rows.h"

#include <array>
#include <cstddef>
#include <cstdint>

/// How rows of bytes are decimated as they are read, for the widest vectors that this CPU has
/// (Highway); the result is the same on all of them. No byte before a row's first or after its last
/// is read.
namespace saliency::kernels {

/// How many rows of half the height are made at once: sums are read and written once for all of
/// them.
constexpr int kAtOnce = 2;
template <typename T> using AtOnce = std::array<T, kAtOnce>;

/// Rows 2y + 1 and 2y + 2 of an image, and those that follow, two for each row that is made.
constexpr std::ptrdiff_t kSourceRows = std::ptrdiff_t{ 2 } * kAtOnce;
using SourceRows = std::array<const std::uint8_t *, kSourceRows>;

/// What rows leave for those that follow: of rows of bytes, each halved from side to side times 16
/// (h), h[2y - 2] + 4 h[2y - 1] + 6 h[2y], and h[2y], where y is the next row of half the height;
/// where rows are quartered, also rows y - 3, y - 2 and y - 1. kBlock numbers of each kind lie one
/// after the other, then as many more of each; a row's second place begins a block.
struct Carried
{
  static constexpr std::ptrdiff_t kBlock = 32;
  static constexpr int kHalved = 2; ///< kinds
  static constexpr int kQuartered = 5;

  std::uint16_t *first;
  /// Rows from y on that there are, of kAtOnce; beyond the last they are mirrored without repeating
  /// it. Of no meaning where rows are not quartered.
  int more = kAtOnce;
};

/// Every other sample of [1 4 6 4 1]/16 along both axes, mirrored at a row's ends without repeating
/// them: from rows of `width` bytes and what those before them left, rows y, y + 1, … of half the
/// height, rounded half up to code values times 128, and what the next need.
void halve_bytes(const SourceRows &rows, int width, const Carried &carried,
                 const AtOnce<Fixed *> &halved, const Ahead &ahead);

/// The same of pixels of two bytes, which go to rows of their own; there are two numbers a pixel.
/// Or of four bytes, the first three of which do so; there are four, and the last byte of a row
/// need not be there.
void halve_pixels(const SourceRows &rows, int width, const Carried &carried,
                  const AtOnce<std::array<Fixed *, 2>> &halved, const Ahead &ahead);
void halve_pixels(const SourceRows &rows, int width, const Carried &carried,
                  const AtOnce<std::array<Fixed *, 3>> &halved, const Ahead &ahead);

/// Halves once more from top to bottom, as halve_rows() does, what halve_bytes() makes: row (y - 1)
/// / 2 of a quarter of the height.
void quarter_bytes(const SourceRows &rows, int width, const Carried &carried, Fixed *quartered,
                   const Ahead &ahead);

/// The same of what halve_pixels() makes.
void quarter_pixels(const SourceRows &rows, int width, const Carried &carried,
                    const std::array<Fixed *, 2> &quartered, const Ahead &ahead);
void quarter_pixels(const SourceRows &rows, int width, const Carried &carried,
                    const std::array<Fixed *, 3> &quartered, const Ahead &ahead);

} // namespace saliency::kernels
