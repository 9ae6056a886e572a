// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/image_rows.h"

#include <array>

/// How rows of samples are decimated, and brought to twice their width where chroma has too few,
/// for the widest vectors that this CPU has (Highway); the result is the same on all of them. No
/// sample before a row's first or after its last is read or written.
namespace saliency::kernels {

/// Every other sample of [1 4 6 4 1]/16 along a row, mirrored at its ends without repeating them;
/// of Fixed rounded down.
void halve_columns(const Fixed *row, int width, Fixed *halved);
void halve_columns(const float *row, int width, float *halved);

/// [1 4 6 4 1]/16 over five rows; of Fixed by means of two, each rounded half up.
void halve_rows(const std::array<const Fixed *, 5> &rows, int count, Fixed *halved);
void halve_rows(const std::array<const float *, 5> &rows, int count, float *halved);

/// `width` samples, at every other place those of `in` and between them their means, rounded half
/// up; the last is repeated where it is followed by one more.
void double_columns(const Fixed *in, int width, Fixed *out);

/// The means of two rows, rounded half up.
void average(const Fixed *a, const Fixed *b, int count, Fixed *out);

} // namespace saliency::kernels
