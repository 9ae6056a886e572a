// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/image_rows.h"
#include "frame/prefetch.h"

#include <array>
#include <cstddef>
#include <cstdint>

/// Decimation of 8-bit rows as they are read, with the widest vectors of this CPU (Highway).
/// Results are identical on every CPU. No byte before the start or after the end of a row is read.
namespace saliency::kernels {

/// Rows of half the height made per call, so that the carried sums are loaded and stored only once.
constexpr int kAtOnce = 2;
template <typename T> using AtOnce = std::array<T, kAtOnce>;

/// Source rows 2y + 1, 2y + 2 and those that follow, two for each row that is made.
constexpr std::ptrdiff_t kSourceRows = std::ptrdiff_t{ 2 } * kAtOnce;
using SourceRows = std::array<const std::uint8_t *, kSourceRows>;

/// State carried from one call to the next. Let h be the source rows halved horizontally, times 16,
/// and y the next row of half the height. The state is h[2y - 2] + 4 h[2y - 1] + 6 h[2y], and
/// h[2y]. When quartering, it also has rows y - 3, y - 2 and y - 1.
///
/// Layout: kBlock numbers of the first kind, then kBlock of the next kind and so on, repeated along
/// the row. Sample 1 of a row starts a block.
struct Carried
{
  static constexpr std::ptrdiff_t kBlock = 32;
  static constexpr int kHalved = 2; ///< kinds
  static constexpr int kQuartered = 5;

  std::uint16_t *first;
  /// How many of the kAtOnce rows from y on exist; rows beyond the last are mirrored
  /// (BORDER_REFLECT_101). Ignored unless quartering.
  int more = kAtOnce;
};

/// Makes rows y, y + 1, … of half the width and height: every other sample of the kernel
/// [1 4 6 4 1]/16 along both axes, ends mirrored (BORDER_REFLECT_101). `rows` are `width` bytes
/// each. Output is in code values times 128, rounded half up. Updates `carried`.
void halve_bytes(const SourceRows &rows, int width, const Carried &carried,
                 const AtOnce<Fixed *> &halved, const Prefetch &ahead);

/// The same for pixels of two bytes, or of four bytes of which the first three count; each
/// component goes to a row of its own. `carried` holds two or four numbers per pixel. The last byte
/// of a row of four-byte pixels is never read.
void halve_pixels(const SourceRows &rows, int width, const Carried &carried,
                  const AtOnce<std::array<Fixed *, 2>> &halved, const Prefetch &ahead);
void halve_pixels(const SourceRows &rows, int width, const Carried &carried,
                  const AtOnce<std::array<Fixed *, 3>> &halved, const Prefetch &ahead);

/// As halve_bytes(), and halves its rows once more vertically as halve_rows() does: makes row
/// (y - 1) / 2 of a quarter of the height.
void quarter_bytes(const SourceRows &rows, int width, const Carried &carried, Fixed *quartered,
                   const Prefetch &ahead);

/// The same for the pixels of halve_pixels().
void quarter_pixels(const SourceRows &rows, int width, const Carried &carried,
                    const std::array<Fixed *, 2> &quartered, const Prefetch &ahead);
void quarter_pixels(const SourceRows &rows, int width, const Carried &carried,
                    const std::array<Fixed *, 3> &quartered, const Prefetch &ahead);

} // namespace saliency::kernels
