// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

/// What is done to rows of samples, vectorized for the processor at hand (Highway). Every target gives
/// the same to the bit: sums are written out, nothing is fused, and whatever is added up over a row is
/// a count. Rows do not overlap unless it is said.
namespace saliency::rows {

/// The taps [1 4 6 4 1]/16 across five rows of n samples.
void smooth(const std::array<const float *, 5> &in, std::size_t n, float *out);

/// The same taps along a row, even samples kept: out[i] from in[2i - 2]…in[2i + 2], i < n.
void halve(const float *in, std::size_t n, float *out);

/// out = before + weight × (after - before). `out` may be one of them.
void interpolate(const float *before, const float *after, float weight, std::size_t n, float *out);

/// A row to one finer by `octaves` < 31: sample i goes to i × 2^octaves, linear interpolation between,
/// the last of `length` samples repeated. Writes n.
void enlarge(const float *in, std::size_t length, int octaves, std::size_t n, float *out);

/// n pixels L*a*b* L*a*b* … to three rows, and back.
void split(const float *lab, std::size_t n, const std::array<float *, 3> &planes);
void join(const std::array<const float *, 3> &planes, std::size_t n, float *lab);

/// w² (Δa² + Δb²) of a row of L*a*b* pixels to a surround in planes.
void chroma_contrast(const float *lab, const float *surround_a, const float *surround_b,
                     float weight_squared, std::size_t n, float *out);

/// √(ΔL² + chroma), likewise; `out` may be `chroma`.
void contrast(const float *lab, const float *surround_lightness, const float *chroma, std::size_t n,
              float *out);

/// Of n L*a*b* pixels, those whose squared ΔE is above a limit.
std::size_t count_changed(const float *lab, const float *before, float limit_squared,
                          std::size_t n);

/// An integral over time at a moment between two: before + part × (after - before).
struct Integral
{
  const double *before;
  const double *after;
  double part;
};

/// sum = base + duration × map. `sum` may be `base`.
void integrate(const double *base, const float *map, double duration, std::size_t n, double *sum);

/// out = (to - from) × scale.
void difference(const Integral &from, const Integral &to, double scale, std::size_t n, float *out);

} // namespace saliency::rows
