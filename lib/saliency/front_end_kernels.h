// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <cstdint>

/// What is done to a row of samples, for the widest vectors that this CPU has (Highway); the result
/// is the same on all of them. Rows lie in a RowBuffer, whose room the kernels use, except where
/// one says how far it reads or writes.
namespace saliency::kernels {

/// `count` samples of a component in a frame's memory, `stride` bytes apart: 8 bits each, or
/// 16-bit words `(word >> shift) & mask`. No byte is read before the first or after the last one.
void unpack(const std::uint8_t *in, int stride, int count, std::uint8_t *out);
void unpack(const std::uint8_t *in, int stride, int shift, unsigned mask, int count,
            std::uint16_t *out);

/// Every other sample of [1 4 6 4 1] along a row of `width` samples, mirrored at its ends: 16 times
/// their mean for integers, the mean for float. Writes the mirrored samples into the row's room.
void halve_columns(std::uint8_t *row, int width, std::uint16_t *halved);
void halve_columns(std::uint16_t *row, int width, std::uint32_t *halved);
void halve_columns(float *row, int width, float *halved);

/// [1 4 6 4 1] over five rows: a 256th of it for integers, rounded half up, the mean for float.
void halve_rows(const std::array<const std::uint16_t *, 5> &rows, int count, std::uint8_t *halved);
void halve_rows(const std::array<const std::uint32_t *, 5> &rows, int count, std::uint16_t *halved);
void halve_rows(const std::array<const float *, 5> &rows, int count, float *halved);

void to_float(const std::uint8_t *in, int count, float *out);
void to_float(const std::uint16_t *in, int count, float *out);

/// before + weight · (after - before)
void interpolate(const float *before, const float *after, float weight, int count, float *out);

/// Twice as many samples, those between by linear interpolation, the last one repeated. `width`: of
/// `row`; writes into the row's room.
void double_columns(float *row, int width, float *out);

/// Three rows as one of `count` triples. Writes no further.
void interleave(const float *first, const float *second, const float *third, int count, float *out);

} // namespace saliency::kernels
