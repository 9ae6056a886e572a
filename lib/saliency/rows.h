// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <cstddef>

/// What is done to rows of samples, vectorized for the processor at hand (Highway). Every target
/// gives the same to the bit: sums are written out, nothing is fused, and whatever is added up over
/// a row is a count. Rows do not overlap unless it is said.
namespace saliency::rows {

/// A row a share `weight` of the way from one row of `length` samples to another.
struct Between
{
  const float *before;
  const float *after;
  float weight;
  std::size_t length;
};

/// A row to one finer by `octaves` < 31: sample i goes to i × 2^octaves, linear interpolation
/// between, the last sample repeated. Writes n.
void enlarge(const Between &row, int octaves, std::size_t n, float *out);

/// w² (Δa² + Δb²) of rows of a* and b* to their surrounds.
void chroma_contrast(const std::array<const float *, 2> &ab,
                     const std::array<const float *, 2> &surround, float weight_squared,
                     std::size_t n, float *out);

/// √(ΔL² + chroma), likewise.
void contrast(const float *lightness, const float *surround, const float *chroma, std::size_t n,
              float *out);

/// Of n L*a*b* pixels, those whose squared ΔE is above a limit.
std::size_t count_changed(const std::array<const float *, 3> &lab,
                          const std::array<const float *, 3> &before, float limit_squared,
                          std::size_t n);

/// Moves those of n values that are at least `low` and below `high` to the front, in their order;
/// how many these are.
std::size_t keep_between(float low, float high, std::size_t n, float *values);

/// center / (surround + nothing) of those of n samples whose center is above `least`, one after the
/// other into `ratios`, n of which there is room for. How many these are, and how many of them are
/// above 1.
struct Gains
{
  std::size_t count;
  std::size_t gained;
};
Gains gains(const float *center, const float *surround, float least, float nothing, std::size_t n,
            float *ratios);

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
