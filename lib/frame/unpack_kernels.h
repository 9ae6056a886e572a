// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/image_rows.h"
#include "frame/prefetch.h"

#include <array>
#include <cstdint>

/// Kernels that move samples from a frame's memory layout to rows of their own, and from Fixed to
/// float; otherwise as in decimation_kernels.h.
namespace saliency::kernels {

/// Every `stride`-th byte, `count` of them.
void unpack(const std::uint8_t *in, int stride, int count, std::uint8_t *out);

/// 16-bit little-endian words `stride` bytes apart: ((word << left) & mask) / 2.
void unpack(const std::uint8_t *in, int stride, int left, unsigned mask, int count, Fixed *out,
            const Prefetch &ahead);

/// Three bytes of every `stride` bytes to three rows; stride ≥ 3.
void unpack_triples(const std::uint8_t *in, int stride, int count,
                    const std::array<std::uint8_t *, 3> &out);

/// Bytes times 128.
void widen(const std::uint8_t *in, int count, Fixed *out);

/// scale · sample + offset
void to_float(const Fixed *in, int count, float scale, float offset, float *out);

} // namespace saliency::kernels
