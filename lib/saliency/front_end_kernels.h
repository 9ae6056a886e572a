// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/image_rows.h"

#include <array>
#include <cstdint>

/// What is done to rows of samples as they are read and decimated, for the widest vectors that this CPU
/// has (Highway); the result is the same on all of them. No sample before a row's first or after its
/// last is read or written.
namespace saliency::kernels {

/// Every `stride`-th byte.
void unpack(const std::uint8_t *in, int stride, int count, std::uint8_t *out);

/// 16-bit little-endian words `stride` bytes apart: half of (word << left) & mask.
void unpack(const std::uint8_t *in, int stride, int left, unsigned mask, int count, Fixed *out);

/// Three bytes of every `stride`, 3 or more, to three rows. `ahead`: where to find as many bytes as are
/// written to each, which will be needed next; they are asked for meanwhile, and need not be there.
void unpack_triples(const std::uint8_t *in, int stride, int count,
                    const std::array<std::uint8_t *, 3> &out, const std::uint8_t *ahead);

/// Bytes times 128.
void widen(const std::uint8_t *in, int count, Fixed *out);

/// Every other sample of [1 4 6 4 1]/16 along a row of `width` samples, mirrored at its ends without
/// repeating them: of bytes 16 times that, of Fixed rounded down. `ahead`: as above, `width` bytes.
void halve_columns(const std::uint8_t *row, int width, std::uint16_t *halved,
                   const std::uint8_t *ahead);
void halve_columns(const Fixed *row, int width, Fixed *halved);
void halve_columns(const float *row, int width, float *halved);

/// [1 4 6 4 1]/16 over five rows: of halved bytes, rounded half up to code values times 128; of Fixed
/// by means of two, each rounded half up.
void halve_rows_of_sums(const std::array<const std::uint16_t *, 5> &rows, int count, Fixed *halved);
void halve_rows(const std::array<const Fixed *, 5> &rows, int count, Fixed *halved);
void halve_rows(const std::array<const float *, 5> &rows, int count, float *halved);

/// `width` samples, at every other place those of `in` and between them their means, rounded half up;
/// the last is repeated where it is followed by one more.
void double_columns(const Fixed *in, int width, Fixed *out);

/// The means of two rows, rounded half up.
void average(const Fixed *a, const Fixed *b, int count, Fixed *out);

/// scale · sample + offset
void to_float(const Fixed *in, int count, float scale, float offset, float *out);

} // namespace saliency::kernels
