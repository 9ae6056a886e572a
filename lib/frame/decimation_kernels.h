// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/image_rows.h"

#include <array>

/// Decimation of rows, and interpolation of subsampled chroma, with the widest vectors of this CPU
/// (Highway). Results are identical on every CPU. No sample outside a row is read or written.
namespace saliency::kernels {

/// Every other sample of [1 4 6 4 1]/16 along a row of `width` samples, ends mirrored
/// (BORDER_REFLECT_101). Fixed is rounded down.
void halve_columns(const Fixed *row, int width, Fixed *halved);
void halve_columns(const float *row, int width, float *halved);

/// [1 4 6 4 1]/16 over five rows of `count` samples. Fixed is averaged pairwise, each mean rounded
/// half up.
void halve_rows(const std::array<const Fixed *, 5> &rows, int count, Fixed *halved);
void halve_rows(const std::array<const float *, 5> &rows, int count, float *halved);

/// Interpolates a row to `width` samples: even ones are those of `in`, odd ones the means of their
/// neighbors, rounded half up. If `width` is even, the last sample is repeated.
void double_columns(const Fixed *in, int width, Fixed *out);

/// The mean of two rows, rounded half up.
void average(const Fixed *a, const Fixed *b, int count, Fixed *out);

} // namespace saliency::kernels
