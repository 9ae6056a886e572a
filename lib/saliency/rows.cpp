// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/rows.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "saliency/rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "frame/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace saliency::rows::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using saliency::HWY_NAMESPACE::compress;
using saliency::HWY_NAMESPACE::cover;
using saliency::HWY_NAMESPACE::each_once;

template <class D>
HWY_INLINE hn::Vec<D>
mix(D d, const float *before, const float *after, hn::Vec<D> weight)
{
  const auto b = hn::LoadU(d, before);
  return hn::Add(b, hn::Mul(weight, hn::Sub(hn::LoadU(d, after), b)));
}

void
enlarge(const Between &in, int octaves, std::size_t n, float *out)
{
  const std::size_t step = std::size_t{ 1 } << octaves;
  const auto sample = [&in](std::size_t i) {
    return in.before[i] + in.weight * (in.after[i] - in.before[i]);
  };
  // Source samples whose upsampled samples all lie before n and that have a successor.
  const std::size_t whole = std::min(n / step, in.length - 1);
  float next = sample(0);
  if (octaves == 1)
    cover<float>(whole, [&](auto d, std::size_t i) HWY_ATTR {
      const auto weight = hn::Set(d, in.weight);
      const auto b = mix(d, in.before + i, in.after + i, weight);
      const auto a = mix(d, in.before + i + 1, in.after + i + 1, weight);
      const auto between = hn::Mul(hn::Set(d, 0.5F), hn::Sub(a, b));
      hn::StoreInterleaved2(b, hn::Add(b, between), d, out + 2 * i);
    });
  else if (octaves == 0)
    cover<float>(whole, [&](auto d, std::size_t i) HWY_ATTR {
      hn::StoreU(mix(d, in.before + i, in.after + i, hn::Set(d, in.weight)), d, out + i);
    });
  else
    for (std::size_t i = 0; i < whole; ++i) {
      const hn::CappedTag<float, 4> d;
      const float start = next;
      next = sample(i + 1);
      const auto first = hn::Set(d, start);
      const auto rise = hn::Set(d, next - start);
      for (std::size_t j = 0; j < step; j += hn::Lanes(d)) {
        const auto part
            = hn::Mul(hn::Iota(d, static_cast<float>(j)), hn::Set(d, 1 / static_cast<float>(step)));
        hn::StoreU(hn::Add(first, hn::Mul(part, rise)), d, out + i * step + j);
      }
    }
  for (std::size_t x = whole * step; x < n; ++x) {
    const std::size_t before = std::min(x >> octaves, in.length - 1);
    const std::size_t after = std::min(before + 1, in.length - 1);
    const float part = static_cast<float>(x & (step - 1)) / static_cast<float>(step);
    out[x] = sample(before) + part * (sample(after) - sample(before));
  }
}

void
chroma_contrast(const std::array<const float *, 2> &ab,
                const std::array<const float *, 2> &surround, float weight_squared, std::size_t n,
                float *out)
{
  cover<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    const auto a = hn::Sub(hn::LoadU(d, ab[0] + i), hn::LoadU(d, surround[0] + i));
    const auto b = hn::Sub(hn::LoadU(d, ab[1] + i), hn::LoadU(d, surround[1] + i));
    const auto squared = hn::Add(hn::Mul(a, a), hn::Mul(b, b));
    hn::StoreU(hn::Mul(hn::Set(d, weight_squared), squared), d, out + i);
  });
}

void
contrast(const float *lightness, const float *surround, const float *chroma, std::size_t n,
         float *out)
{
  cover<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    const auto l = hn::Sub(hn::LoadU(d, lightness + i), hn::LoadU(d, surround + i));
    hn::StoreU(hn::Sqrt(hn::Add(hn::Mul(l, l), hn::LoadU(d, chroma + i))), d, out + i);
  });
}

std::size_t
count_changed(const std::array<const float *, 3> &lab, const std::array<const float *, 3> &before,
              float limit_squared, std::size_t n)
{
  std::size_t count = 0;
  each_once<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    const auto l = hn::Sub(hn::LoadU(d, lab[0] + i), hn::LoadU(d, before[0] + i));
    const auto a = hn::Sub(hn::LoadU(d, lab[1] + i), hn::LoadU(d, before[1] + i));
    const auto b = hn::Sub(hn::LoadU(d, lab[2] + i), hn::LoadU(d, before[2] + i));
    const auto squared = hn::Add(hn::Mul(l, l), hn::Add(hn::Mul(a, a), hn::Mul(b, b)));
    count += hn::CountTrue(d, hn::Gt(squared, hn::Set(d, limit_squared)));
  });
  return count;
}

std::size_t
keep_between(float low, float high, std::size_t n, float *values)
{
  std::size_t kept = 0;
  each_once<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    const auto value = hn::LoadU(d, values + i);
    const auto keep = hn::And(hn::Ge(value, hn::Set(d, low)), hn::Lt(value, hn::Set(d, high)));
    kept += compress(d, value, keep, values + kept);
  });
  return kept;
}

void
greatest(const float *in, std::ptrdiff_t step, int count, std::size_t n, float *out)
{
  cover<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    const float *next = in + i;
    auto most = hn::LoadU(d, next);
    for (int k = 1; k < count; ++k) {
      next += step;
      most = hn::Max(most, hn::LoadU(d, next));
    }
    hn::StoreU(most, d, out + i);
  });
}

void
integrate(const double *base, const float *map, std::size_t n, double *sum)
{
  each_once<double>(n, [&](auto d, std::size_t i) HWY_ATTR {
    const hn::Rebind<float, decltype(d)> narrow;
    const auto value = hn::PromoteTo(d, hn::LoadU(narrow, map + i));
    hn::StoreU(hn::Add(hn::LoadU(d, base + i), value), d, sum + i);
  });
}

void
difference(const double *from, const double *to, double scale, std::size_t n, float *out)
{
  cover<double>(n, [&](auto d, std::size_t i) HWY_ATTR {
    const hn::Rebind<float, decltype(d)> narrow;
    const auto value
        = hn::Mul(hn::Sub(hn::LoadU(d, to + i), hn::LoadU(d, from + i)), hn::Set(d, scale));
    hn::StoreU(hn::DemoteTo(narrow, value), narrow, out + i);
  });
}

} // namespace saliency::rows::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saliency::rows {

HWY_EXPORT(enlarge);
HWY_EXPORT(chroma_contrast);
HWY_EXPORT(contrast);
HWY_EXPORT(count_changed);
HWY_EXPORT(keep_between);
HWY_EXPORT(greatest);
HWY_EXPORT(integrate);
HWY_EXPORT(difference);

void
enlarge(const Between &in, int octaves, std::size_t n, float *out)
{
  HWY_DYNAMIC_DISPATCH(enlarge)(in, octaves, n, out);
}

void
chroma_contrast(const std::array<const float *, 2> &ab,
                const std::array<const float *, 2> &surround, float weight_squared, std::size_t n,
                float *out)
{
  HWY_DYNAMIC_DISPATCH(chroma_contrast)(ab, surround, weight_squared, n, out);
}

void
contrast(const float *lightness, const float *surround, const float *chroma, std::size_t n,
         float *out)
{
  HWY_DYNAMIC_DISPATCH(contrast)(lightness, surround, chroma, n, out);
}

std::size_t
count_changed(const std::array<const float *, 3> &lab, const std::array<const float *, 3> &before,
              float limit_squared, std::size_t n)
{
  return HWY_DYNAMIC_DISPATCH(count_changed)(lab, before, limit_squared, n);
}

std::size_t
keep_between(float low, float high, std::size_t n, float *values)
{
  return HWY_DYNAMIC_DISPATCH(keep_between)(low, high, n, values);
}

void
greatest(const float *in, std::ptrdiff_t step, int count, std::size_t n, float *out)
{
  HWY_DYNAMIC_DISPATCH(greatest)(in, step, count, n, out);
}

void
integrate(const double *base, const float *map, std::size_t n, double *sum)
{
  HWY_DYNAMIC_DISPATCH(integrate)(base, map, n, sum);
}

void
difference(const double *from, const double *to, double scale, std::size_t n, float *out)
{
  HWY_DYNAMIC_DISPATCH(difference)(from, to, scale, n, out);
}

} // namespace saliency::rows
#endif
