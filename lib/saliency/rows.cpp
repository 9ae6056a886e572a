// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/rows.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "saliency/rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace saliency::rows::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Calls work(d, i) for i = 0, 1, … n - 1 by whole vectors, then one by one: nothing beyond n is read.
template <typename T, typename Work>
HWY_INLINE void
for_vectors(std::size_t n, const Work &work)
{
  const hn::ScalableTag<T> d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + lanes <= n; i += lanes)
    work(d, i);
  const hn::CappedTag<T, 1> one;
  for (; i < n; ++i)
    work(one, i);
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE V
taps(D d, V outer, V next, V middle)
{
  const V sum
      = hn::Add(outer, hn::Add(hn::Mul(hn::Set(d, 4.0F), next), hn::Mul(hn::Set(d, 6.0F), middle)));
  return hn::Mul(sum, hn::Set(d, 1.0F / 16));
}

void
smooth(const std::array<const float *, 5> &in, std::size_t n, float *out)
{
  for_vectors<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    const auto outer = hn::Add(hn::LoadU(d, in[0] + i), hn::LoadU(d, in[4] + i));
    const auto next = hn::Add(hn::LoadU(d, in[1] + i), hn::LoadU(d, in[3] + i));
    hn::StoreU(taps(d, outer, next, hn::LoadU(d, in[2] + i)), d, out + i);
  });
}

void
halve(const float *in, std::size_t n, float *out)
{
  // Pairs: of these the second of the last is one sample further than is needed.
  const std::size_t pairs = n > 0 ? n - 1 : 0;
  for_vectors<float>(pairs, [&](auto d, std::size_t i) HWY_ATTR {
    const float *at = in + 2 * i;
    hn::Vec<decltype(d)> even0, odd0, even1, odd1, even2, unused;
    hn::LoadInterleaved2(d, at - 2, even0, odd0);
    hn::LoadInterleaved2(d, at, even1, odd1);
    hn::LoadInterleaved2(d, at + 2, even2, unused);
    hn::StoreU(taps(d, hn::Add(even0, even2), hn::Add(odd0, odd1), even1), d, out + i);
  });
  for (std::size_t i = pairs; i < n; ++i) {
    const float *at = in + 2 * i;
    const hn::CappedTag<float, 1> one;
    const auto outer = hn::Add(hn::LoadU(one, at - 2), hn::LoadU(one, at + 2));
    const auto next = hn::Add(hn::LoadU(one, at - 1), hn::LoadU(one, at + 1));
    hn::StoreU(taps(one, outer, next, hn::LoadU(one, at)), one, out + i);
  }
}

void
interpolate(const float *before, const float *after, float weight, std::size_t n, float *out)
{
  for_vectors<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    const auto b = hn::LoadU(d, before + i);
    const auto step = hn::Sub(hn::LoadU(d, after + i), b);
    hn::StoreU(hn::Add(b, hn::Mul(hn::Set(d, weight), step)), d, out + i);
  });
}

void
enlarge(const float *in, std::size_t length, int octaves, std::size_t n, float *out)
{
  const std::size_t step = std::size_t{ 1 } << octaves;
  // Source samples all of whose finer samples lie before n, with one after them.
  const std::size_t whole = std::min(n / step, length - 1);
  if (octaves == 0)
    std::copy_n(in, whole, out);
  else if (octaves == 1)
    for_vectors<float>(whole, [&](auto d, std::size_t i) HWY_ATTR {
      const auto b = hn::LoadU(d, in + i);
      const auto between = hn::Mul(hn::Set(d, 0.5F), hn::Sub(hn::LoadU(d, in + i + 1), b));
      hn::StoreInterleaved2(b, hn::Add(b, between), d, out + 2 * i);
    });
  else
    for (std::size_t i = 0; i < whole; ++i) {
      const float rise = in[i + 1] - in[i];
      const hn::CappedTag<float, 4> d;
      for (std::size_t j = 0; j < step; j += hn::Lanes(d)) {
        const auto part
            = hn::Mul(hn::Iota(d, static_cast<float>(j)), hn::Set(d, 1 / static_cast<float>(step)));
        hn::StoreU(hn::Add(hn::Set(d, in[i]), hn::Mul(part, hn::Set(d, rise))), d,
                   out + i * step + j);
      }
    }
  for (std::size_t x = whole * step; x < n; ++x) {
    const std::size_t before = std::min(x >> octaves, length - 1);
    const std::size_t after = std::min(before + 1, length - 1);
    const float part = static_cast<float>(x & (step - 1)) / static_cast<float>(step);
    out[x] = in[before] + part * (in[after] - in[before]);
  }
}

void
split(const float *lab, std::size_t n, const std::array<float *, 3> &planes)
{
  for_vectors<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    hn::Vec<decltype(d)> l, a, b;
    hn::LoadInterleaved3(d, lab + 3 * i, l, a, b);
    hn::StoreU(l, d, planes[0] + i);
    hn::StoreU(a, d, planes[1] + i);
    hn::StoreU(b, d, planes[2] + i);
  });
}

void
join(const std::array<const float *, 3> &planes, std::size_t n, float *lab)
{
  for_vectors<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    hn::StoreInterleaved3(hn::LoadU(d, planes[0] + i), hn::LoadU(d, planes[1] + i),
                          hn::LoadU(d, planes[2] + i), d, lab + 3 * i);
  });
}

void
chroma_contrast(const float *lab, const float *surround_a, const float *surround_b,
                float weight_squared, std::size_t n, float *out)
{
  for_vectors<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    hn::Vec<decltype(d)> l, a, b;
    hn::LoadInterleaved3(d, lab + 3 * i, l, a, b);
    a = hn::Sub(a, hn::LoadU(d, surround_a + i));
    b = hn::Sub(b, hn::LoadU(d, surround_b + i));
    const auto squared = hn::Add(hn::Mul(a, a), hn::Mul(b, b));
    hn::StoreU(hn::Mul(hn::Set(d, weight_squared), squared), d, out + i);
  });
}

void
contrast(const float *lab, const float *surround_lightness, const float *chroma, std::size_t n,
         float *out)
{
  for_vectors<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    hn::Vec<decltype(d)> l, a, b;
    hn::LoadInterleaved3(d, lab + 3 * i, l, a, b);
    l = hn::Sub(l, hn::LoadU(d, surround_lightness + i));
    hn::StoreU(hn::Sqrt(hn::Add(hn::Mul(l, l), hn::LoadU(d, chroma + i))), d, out + i);
  });
}

std::size_t
count_changed(const float *lab, const float *before, float limit_squared, std::size_t n)
{
  std::size_t count = 0;
  for_vectors<float>(n, [&](auto d, std::size_t i) HWY_ATTR {
    hn::Vec<decltype(d)> l, a, b, l_before, a_before, b_before;
    hn::LoadInterleaved3(d, lab + 3 * i, l, a, b);
    hn::LoadInterleaved3(d, before + 3 * i, l_before, a_before, b_before);
    l = hn::Sub(l, l_before);
    a = hn::Sub(a, a_before);
    b = hn::Sub(b, b_before);
    const auto squared = hn::Add(hn::Mul(l, l), hn::Add(hn::Mul(a, a), hn::Mul(b, b)));
    count += hn::CountTrue(d, hn::Gt(squared, hn::Set(d, limit_squared)));
  });
  return count;
}

void
integrate(const double *base, const float *map, double duration, std::size_t n, double *sum)
{
  for_vectors<double>(n, [&](auto d, std::size_t i) HWY_ATTR {
    const hn::Rebind<float, decltype(d)> narrow;
    const auto value = hn::PromoteTo(d, hn::LoadU(narrow, map + i));
    hn::StoreU(hn::Add(hn::LoadU(d, base + i), hn::Mul(hn::Set(d, duration), value)), d, sum + i);
  });
}

template <class D>
HWY_INLINE hn::Vec<D>
at(D d, const Integral &integral, std::size_t i)
{
  const auto before = hn::LoadU(d, integral.before + i);
  if (integral.part == 0)
    return before;
  const auto step = hn::Sub(hn::LoadU(d, integral.after + i), before);
  return hn::Add(before, hn::Mul(hn::Set(d, integral.part), step));
}

void
difference(const Integral &from, const Integral &to, double scale, std::size_t n, float *out)
{
  for_vectors<double>(n, [&](auto d, std::size_t i) HWY_ATTR {
    const hn::Rebind<float, decltype(d)> narrow;
    const auto value = hn::Mul(hn::Sub(at(d, to, i), at(d, from, i)), hn::Set(d, scale));
    hn::StoreU(hn::DemoteTo(narrow, value), narrow, out + i);
  });
}

} // namespace saliency::rows::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saliency::rows {

HWY_EXPORT(smooth);
HWY_EXPORT(halve);
HWY_EXPORT(interpolate);
HWY_EXPORT(enlarge);
HWY_EXPORT(split);
HWY_EXPORT(join);
HWY_EXPORT(chroma_contrast);
HWY_EXPORT(contrast);
HWY_EXPORT(count_changed);
HWY_EXPORT(integrate);
HWY_EXPORT(difference);

void
smooth(const std::array<const float *, 5> &in, std::size_t n, float *out)
{
  HWY_DYNAMIC_DISPATCH(smooth)(in, n, out);
}

void
halve(const float *in, std::size_t n, float *out)
{
  HWY_DYNAMIC_DISPATCH(halve)(in, n, out);
}

void
interpolate(const float *before, const float *after, float weight, std::size_t n, float *out)
{
  HWY_DYNAMIC_DISPATCH(interpolate)(before, after, weight, n, out);
}

void
enlarge(const float *in, std::size_t length, int octaves, std::size_t n, float *out)
{
  HWY_DYNAMIC_DISPATCH(enlarge)(in, length, octaves, n, out);
}

void
split(const float *lab, std::size_t n, const std::array<float *, 3> &planes)
{
  HWY_DYNAMIC_DISPATCH(split)(lab, n, planes);
}

void
join(const std::array<const float *, 3> &planes, std::size_t n, float *lab)
{
  HWY_DYNAMIC_DISPATCH(join)(planes, n, lab);
}

void
chroma_contrast(const float *lab, const float *surround_a, const float *surround_b,
                float weight_squared, std::size_t n, float *out)
{
  HWY_DYNAMIC_DISPATCH(chroma_contrast)(lab, surround_a, surround_b, weight_squared, n, out);
}

void
contrast(const float *lab, const float *surround_lightness, const float *chroma, std::size_t n,
         float *out)
{
  HWY_DYNAMIC_DISPATCH(contrast)(lab, surround_lightness, chroma, n, out);
}

std::size_t
count_changed(const float *lab, const float *before, float limit_squared, std::size_t n)
{
  return HWY_DYNAMIC_DISPATCH(count_changed)(lab, before, limit_squared, n);
}

void
integrate(const double *base, const float *map, double duration, std::size_t n, double *sum)
{
  HWY_DYNAMIC_DISPATCH(integrate)(base, map, duration, n, sum);
}

void
difference(const Integral &from, const Integral &to, double scale, std::size_t n, float *out)
{
  HWY_DYNAMIC_DISPATCH(difference)(from, to, scale, n, out);
}

} // namespace saliency::rows
#endif
