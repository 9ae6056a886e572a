// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <cstdint>

namespace saliency::kernels {

/// Sums of each column over `rows` ≤ 256 rows of `count` bytes, which are `stride` bytes apart,
/// with the widest vectors of this CPU (Highway).
void sum_rows(const std::uint8_t *first, std::ptrdiff_t stride, int rows, std::size_t count,
              std::uint16_t *sums);

/// The same of little-endian words: of (word >> shift) & 255.
void sum_rows(const std::uint8_t *first, std::ptrdiff_t stride, int rows, int shift,
              std::size_t count, std::uint16_t *sums);

} // namespace saliency::kernels
