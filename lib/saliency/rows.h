// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <cstddef>

/// Row operations, vectorized for this CPU (Highway). Results are bit-identical on every CPU: the
/// order of additions is fixed, there is no FMA, and only counts are summed along a row. Rows must
/// not overlap unless stated.
namespace saliency::rows {

/// A row interpolated between two rows of `length` samples: before + weight × (after - before).
struct Between
{
  const float *before;
  const float *after;
  float weight;
  std::size_t length;
};

/// Upsamples a row by `octaves` < 31: sample i goes to i × 2^octaves, with linear interpolation
/// between and the last sample repeated. Writes `n` samples.
void enlarge(const Between &row, int octaves, std::size_t n, float *out);

/// w² (Δa² + Δb²) of `n` samples of a* and b* and their surrounds.
void chroma_contrast(const std::array<const float *, 2> &ab,
                     const std::array<const float *, 2> &surround, float weight_squared,
                     std::size_t n, float *out);

/// √(ΔL² + chroma) of `n` samples.
void contrast(const float *lightness, const float *surround, const float *chroma, std::size_t n,
              float *out);

/// How many of n L*a*b* pixels have a squared ΔE above the limit.
std::size_t count_changed(const std::array<const float *, 3> &lab,
                          const std::array<const float *, 3> &before, float limit_squared,
                          std::size_t n);

/// Moves those of n values in [low, high) to the front, in order; returns their number.
std::size_t keep_between(float low, float high, std::size_t n, float *values);

/// out[i] = the greatest of in[i], in[i + step], …, in[i + (count - 1) · step], for n samples.
void greatest(const float *in, std::ptrdiff_t step, int count, std::size_t n, float *out);

/// sum = base + map. `sum` may be `base`.
void integrate(const double *base, const float *map, std::size_t n, double *sum);

/// out = (to - from) × scale.
void difference(const double *from, const double *to, double scale, std::size_t n, float *out);

} // namespace saliency::rows
