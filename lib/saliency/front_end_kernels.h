// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <cstdint>

/// What is done to rows of samples as they are read and decimated, for the widest vectors that this CPU
/// has (Highway); the result is the same on all of them. No sample before a row's first or after its
/// last is read or written.
namespace saliency::kernels {

/// Every `stride`-th byte.
void unpack(const std::uint8_t *in, int stride, int count, std::uint8_t *out);

/// 16-bit little-endian words `stride` bytes apart: (word << left) & mask.
void unpack(const std::uint8_t *in, int stride, int left, unsigned mask, int count,
            std::uint16_t *out);

/// Three bytes of every `stride`, 3 or more, to three rows.
void unpack_triples(const std::uint8_t *in, int stride, int count,
                    const std::array<std::uint8_t *, 3> &out);

/// Every other sample of [1 4 6 4 1] along a row of `width` samples, mirrored at its ends without
/// repeating them: 16 times their mean for integers, the mean for float.
void halve_columns(const std::uint8_t *row, int width, std::uint16_t *halved);
void halve_columns(const std::uint16_t *row, int width, std::uint32_t *halved);
void halve_columns(const float *row, int width, float *halved);

/// [1 4 6 4 1] over five rows: of 16-bit numbers as it is, which has to fit; of 32-bit numbers a 256th
/// of it, rounded half up; the mean for float.
void halve_rows(const std::array<const std::uint16_t *, 5> &rows, int count, std::uint16_t *halved);
void halve_rows(const std::array<const std::uint32_t *, 5> &rows, int count, std::uint16_t *halved);
void halve_rows(const std::array<const float *, 5> &rows, int count, float *halved);

/// Integers times a scale.
void to_float(const std::uint8_t *in, int count, float scale, float *out);
void to_float(const std::uint16_t *in, int count, float scale, float *out);

} // namespace saliency::kernels
