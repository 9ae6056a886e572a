// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame/decimation_kernels.h"

#include <array>
#include <cstddef>

// Everything up to HWY_ONCE is compiled once per target, without FMA: results are bit-identical.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "frame/decimation_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "frame/five_taps-inl.h"
#include "frame/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace saliency::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using saliency::HWY_NAMESPACE::cover;
using saliency::HWY_NAMESPACE::for_halved;
using saliency::HWY_NAMESPACE::halved_sums;
using saliency::HWY_NAMESPACE::load_bytes;
using saliency::HWY_NAMESPACE::mean_of_five;
using saliency::HWY_NAMESPACE::Taps;
using saliency::HWY_NAMESPACE::weigh_taps;
template <typename T> using Tag = saliency::HWY_NAMESPACE::Vectors<T>;

/// Covers output indices from x on by vectors of `step`: `work(x)` reads samples 2x - 2…2x + 2 step
/// + 1 of `readable`. The last vector may overlap the one before it. Returns where it stopped.
template <typename Work>
HWY_INLINE int
cover_halved(int x, int readable, int step, const Work &work)
{
  const int last = (readable - 2) / 2 - step;
  if (last < x)
    return x;
  for (; x < last; x += step)
    work(x);
  work(last);
  return last + step;
}

void
HalveColumns16(const Fixed *row, int width, Fixed *out)
{
  const Tag<std::uint32_t> d;
  const auto work = [=](std::ptrdiff_t x) HWY_ATTR {
    const hn::RebindToSigned<decltype(d)> integers;
    const hn::Rebind<Fixed, decltype(d)> narrow;
    const auto mean = hn::ShiftRight<4>(halved_sums<1>(
        d, [d, at = row + 2 * x](std::ptrdiff_t i) HWY_ATTR { return load_bytes(d, at + 2 * i); }));
    hn::StoreU(hn::DemoteTo(narrow, hn::BitCast(integers, mean)), narrow, out + x);
  };
  const auto many = [width, d, &work](int x) HWY_ATTR {
    return cover_halved(x, width, static_cast<int>(hn::Lanes(d)), work);
  };
  for_halved(width, many, [&](int x, const Taps &taps) {
    out[x] = static_cast<Fixed>(weigh_taps(taps, [row](int i) { return row[i]; }) / 16);
  });
}

template <class D, class V = hn::VFromD<D>>
HWY_INLINE V
gaussian(D d, V v0, V v1, V v2, V v3, V v4)
{
  const V outer = hn::Add(hn::Add(v0, v4), hn::Mul(hn::Set(d, 4.0F), hn::Add(v1, v3)));
  return hn::Mul(hn::Add(outer, hn::Mul(hn::Set(d, 6.0F), v2)), hn::Set(d, 1.0F / 16));
}

void
HalveColumnsFloat(const float *row, int width, float *out)
{
  const Tag<float> d;
  const auto work = [=](std::ptrdiff_t x) HWY_ATTR {
    const float *at = row + 2 * x;
    hn::Vec<decltype(d)> v0, v1, v2, v3, v4, v5;
    hn::LoadInterleaved2(d, at - 2, v0, v1);
    hn::LoadInterleaved2(d, at, v2, v3);
    hn::LoadInterleaved2(d, at + 2, v4, v5);
    hn::StoreU(gaussian(d, v0, v1, v2, v3, v4), d, out + x);
  };
  const auto many = [width, d, &work](int x) HWY_ATTR {
    return cover_halved(x, width, static_cast<int>(hn::Lanes(d)), work);
  };
  for_halved(width, many, [&](int x, const Taps &taps) {
    out[x] = weigh_taps(taps, [row](int i) { return row[i]; }) * (1.0F / 16);
  });
}

void
HalveRows16(std::array<const Fixed *, 5> rows, int count, Fixed *halved)
{
  cover<Fixed>(count, [=](auto d, int x) HWY_ATTR {
    hn::StoreU(mean_of_five(hn::LoadU(d, rows[0] + x), hn::LoadU(d, rows[1] + x),
                            hn::LoadU(d, rows[2] + x), hn::LoadU(d, rows[3] + x),
                            hn::LoadU(d, rows[4] + x)),
               d, halved + x);
  });
}

void
HalveRowsFloat(std::array<const float *, 5> rows, int count, float *halved)
{
  cover<float>(count, [=](auto d, int x) HWY_ATTR {
    hn::StoreU(gaussian(d, hn::LoadU(d, rows[0] + x), hn::LoadU(d, rows[1] + x),
                        hn::LoadU(d, rows[2] + x), hn::LoadU(d, rows[3] + x),
                        hn::LoadU(d, rows[4] + x)),
               d, halved + x);
  });
}

void
DoubleColumns(const Fixed *in, int width, Fixed *out)
{
  const int between = (width - 1) / 2; // interpolated samples, one fewer than given ones
  cover<Fixed>(between, [=](auto d, std::ptrdiff_t x) HWY_ATTR {
    const auto sample = hn::LoadU(d, in + x);
    hn::StoreInterleaved2(sample, hn::AverageRound(sample, hn::LoadU(d, in + x + 1)), d,
                          out + 2 * x);
  });
  for (int x = 2 * between; x < width; ++x)
    out[x] = in[between];
}

void
Average(const Fixed *a, const Fixed *b, int count, Fixed *out)
{
  cover<Fixed>(count, [=](auto d, int x) HWY_ATTR {
    hn::StoreU(hn::AverageRound(hn::LoadU(d, a + x), hn::LoadU(d, b + x)), d, out + x);
  });
}

} // namespace saliency::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saliency::kernels {

HWY_EXPORT(HalveColumns16);
HWY_EXPORT(HalveColumnsFloat);
HWY_EXPORT(HalveRows16);
HWY_EXPORT(HalveRowsFloat);
HWY_EXPORT(DoubleColumns);
HWY_EXPORT(Average);

void
halve_columns(const Fixed *row, int width, Fixed *halved)
{
  HWY_DYNAMIC_DISPATCH(HalveColumns16)(row, width, halved);
}

void
halve_columns(const float *row, int width, float *halved)
{
  HWY_DYNAMIC_DISPATCH(HalveColumnsFloat)(row, width, halved);
}

void
halve_rows(const std::array<const Fixed *, 5> &rows, int count, Fixed *halved)
{
  HWY_DYNAMIC_DISPATCH(HalveRows16)(rows, count, halved);
}

void
halve_rows(const std::array<const float *, 5> &rows, int count, float *halved)
{
  HWY_DYNAMIC_DISPATCH(HalveRowsFloat)(rows, count, halved);
}

void
double_columns(const Fixed *in, int width, Fixed *out)
{
  HWY_DYNAMIC_DISPATCH(DoubleColumns)(in, width, out);
}

void
average(const Fixed *a, const Fixed *b, int count, Fixed *out)
{
  HWY_DYNAMIC_DISPATCH(Average)(a, b, count, out);
}

} // namespace saliency::kernels
#endif
