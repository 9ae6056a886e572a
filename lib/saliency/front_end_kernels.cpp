// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/front_end_kernels.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <type_traits>

// Everything up to HWY_ONCE is compiled for each target. No fused multiply-add, which not all have.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "saliency/front_end_kernels.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "saliency/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace saliency::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using saliency::HWY_NAMESPACE::cover;
template <typename T> using Tag = saliency::HWY_NAMESPACE::Vectors<T>;

/// Lanes from memory that need not be aligned for them: as many samples of less width as fit.
template <class D>
HWY_INLINE hn::VFromD<D>
load_bytes(D d, const void *bytes)
{
  hn::TFromD<D> lane;
  if constexpr (hn::MaxLanes(D()) == 1) {
    std::memcpy(&lane, bytes, sizeof lane);
    return hn::Set(d, lane);
  } else {
    const hn::Repartition<std::uint8_t, D> d8;
    return hn::BitCast(d, hn::LoadU(d8, static_cast<const std::uint8_t *>(bytes)));
  }
}

void
Unpack8(const std::uint8_t *in, int stride, int count, std::uint8_t *out)
{
  int x = 0;
#if HWY_TARGET != HWY_SCALAR
  // Vectors end with the bytes between two samples, so they stop short of the last sample.
  const Tag<std::uint8_t> d;
  const hn::Repartition<std::uint16_t, decltype(d)> d16;
  const int step = static_cast<int>(hn::Lanes(d));
  if (stride == 2) {
    for (; x + step < count; x += step) {
      const auto *at = in + static_cast<std::ptrdiff_t>(x) * 2;
      hn::StoreU(hn::ConcatEven(d, hn::LoadU(d, at + step), hn::LoadU(d, at)), d, out + x);
    }
  } else if (stride == 4) {
    for (; x + step < count; x += step) {
      const auto *at = in + static_cast<std::ptrdiff_t>(x) * 4;
      const auto low = hn::ConcatEven(d16, load_bytes(d16, at + step), load_bytes(d16, at));
      const auto high
          = hn::ConcatEven(d16, load_bytes(d16, at + 3 * step), load_bytes(d16, at + 2 * step));
      hn::StoreU(hn::ConcatEven(d, hn::BitCast(d, high), hn::BitCast(d, low)), d, out + x);
    }
  }
#endif
  for (; x < count; ++x)
    out[x] = in[static_cast<std::ptrdiff_t>(x) * stride];
}

void
Unpack16(const std::uint8_t *in, int stride, int left, unsigned mask, int count, Fixed *out)
{
  int x = 0;
#if HWY_TARGET != HWY_SCALAR
  const Tag<std::uint16_t> d;
  const int step = static_cast<int>(hn::Lanes(d));
  const auto bits = hn::Set(d, static_cast<std::uint16_t>(mask));
  if (stride == 2) {
    for (; x + step <= count; x += step) {
      const auto words = load_bytes(d, in + static_cast<std::ptrdiff_t>(x) * 2);
      hn::StoreU(hn::ShiftRight<1>(hn::And(hn::ShiftLeftSame(words, left), bits)), d, out + x);
    }
  } else if (stride == 4) {
    for (; x + step < count; x += step) {
      const auto *at = in + static_cast<std::ptrdiff_t>(x) * 4;
      const auto words = hn::ConcatEven(d, load_bytes(d, at + 2 * step), load_bytes(d, at));
      hn::StoreU(hn::ShiftRight<1>(hn::And(hn::ShiftLeftSame(words, left), bits)), d, out + x);
    }
  }
#endif
  for (; x < count; ++x) {
    const auto *word = in + static_cast<std::ptrdiff_t>(x) * stride;
    out[x]
        = static_cast<Fixed>((static_cast<unsigned>(word[0] | word[1] << 8) << left & mask) >> 1);
  }
}

void
UnpackTriples(const std::uint8_t *in, int stride, int count,
              const std::array<std::uint8_t *, 3> &out, const std::uint8_t *ahead)
{
  int x = 0;
#if HWY_TARGET == HWY_SCALAR
  static_cast<void>(ahead);
#else
  const Tag<std::uint8_t> d;
  const hn::Repartition<std::uint16_t, decltype(d)> d16;
  const int step = static_cast<int>(hn::Lanes(d));
  if (stride == 3) {
    for (; x + step <= count; x += step) {
      hn::Vec<decltype(d)> first, second, third;
      hn::LoadInterleaved3(d, in + static_cast<std::ptrdiff_t>(x) * 3, first, second, third);
      hn::StoreU(first, d, out[0] + x);
      hn::StoreU(second, d, out[1] + x);
      hn::StoreU(third, d, out[2] + x);
    }
  } else if (stride == 4) {
    for (; x + step < count; x += step) {
      const auto *at = in + static_cast<std::ptrdiff_t>(x) * 4;
      hwy::Prefetch(ahead + x);
      const auto v0 = load_bytes(d16, at);
      const auto v1 = load_bytes(d16, at + step);
      const auto v2 = load_bytes(d16, at + 2 * step);
      const auto v3 = load_bytes(d16, at + 3 * step);
      const auto low_pairs = hn::BitCast(d, hn::ConcatEven(d16, v1, v0));
      const auto high_pairs = hn::BitCast(d, hn::ConcatEven(d16, v3, v2));
      const auto low_thirds = hn::BitCast(d, hn::ConcatOdd(d16, v1, v0));
      const auto high_thirds = hn::BitCast(d, hn::ConcatOdd(d16, v3, v2));
      hn::StoreU(hn::ConcatEven(d, high_pairs, low_pairs), d, out[0] + x);
      hn::StoreU(hn::ConcatOdd(d, high_pairs, low_pairs), d, out[1] + x);
      hn::StoreU(hn::ConcatEven(d, high_thirds, low_thirds), d, out[2] + x);
    }
  }
#endif
  for (; x < count; ++x)
    for (std::size_t c = 0; c < 3; ++c)
      out[c][x] = in[static_cast<std::ptrdiff_t>(x) * stride + static_cast<std::ptrdiff_t>(c)];
}

void
Widen(const std::uint8_t *in, int count, Fixed *out)
{
  cover<Fixed>(count, [&](auto d, int x) HWY_ATTR {
    const auto bytes = hn::LoadU(hn::Rebind<std::uint8_t, decltype(d)>(), in + x);
    hn::StoreU(hn::ShiftLeft<7>(hn::PromoteTo(d, bytes)), d, out + x);
  });
}

/// One of halve_columns.
template <typename Out, typename Sample>
Out
gaussian_of(Sample v0, Sample v1, Sample v2, Sample v3, Sample v4)
{
  if constexpr (std::is_same_v<Sample, float>)
    return (v0 + v4 + 4 * (v1 + v3) + 6 * v2) * (1.0F / 16);
  else
    return static_cast<Out>((v0 + v4 + 4 * (v1 + v3) + 6 * v2) / (sizeof(Sample) == 1 ? 1 : 16));
}

/// `halve(d, at, out)` stores a sample for each lane of d, from those from at[-2] on, two for each and two
/// more.
template <typename Lane, typename Sample, typename Out, typename Halve>
HWY_INLINE void
halve_columns(const Sample *row, int width, Out *out, const Halve &halve)
{
  const Tag<Lane> d;
  const int step = static_cast<int>(hn::Lanes(d));
  const int end = (width + 1) / 2;
  if (width < 5) {
    const auto at = [&](int i) {
      return row[mirrored(i, width)];
    };
    for (int x = 0; x < end; ++x)
      out[x]
          = gaussian_of<Out>(at(2 * x - 2), at(2 * x - 1), at(2 * x), at(2 * x + 1), at(2 * x + 2));
    return;
  }
  out[0] = gaussian_of<Out>(row[2], row[1], row[0], row[1], row[2]);
  int x = 1;
  if (const int last = (width - 2) / 2 - step; last >= 1) { // where a vector fits
    for (; x < last; x += step)
      halve(d, row + 2 * x, out + x);
    halve(d, row + 2 * last, out + last);
    x = last + step;
  }
  const Sample *at = row + 2 * x;
  for (; x + 1 < end; ++x, at += 2)
    out[x] = gaussian_of<Out>(at[-2], at[-1], at[0], at[1], at[2]);
  out[x] = width % 2 == 0 ? gaussian_of<Out>(at[-2], at[-1], at[0], at[1], at[0])
                          : gaussian_of<Out>(at[-2], at[-1], at[0], at[-1], at[-2]);
}

/// even × the first + odd × the second of each pair of numbers half as wide as a lane.
template <int even, int odd, class D>
HWY_INLINE hn::VFromD<D>
weigh_pairs(D d, const void *numbers)
{
  using Lane = hn::TFromD<D>;
  constexpr int kHalf = 4 * sizeof(Lane); // bits
  const auto pairs = load_bytes(d, numbers);
#if HWY_TARGET == HWY_SSSE3 || HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_AVX2                    \
    || HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  // One instruction, which Highway 1.0 does not have.
  const auto weights = hn::Set(d, static_cast<Lane>(even | odd << kHalf));
  constexpr bool kBytes = sizeof(Lane) == 2;
#if HWY_TARGET == HWY_SSSE3 || HWY_TARGET == HWY_SSE4
  return hn::VFromD<D>{ kBytes ? _mm_maddubs_epi16(pairs.raw, weights.raw)
                               : _mm_madd_epi16(pairs.raw, weights.raw) };
#elif HWY_TARGET == HWY_AVX2
  return hn::VFromD<D>{ kBytes ? _mm256_maddubs_epi16(pairs.raw, weights.raw)
                               : _mm256_madd_epi16(pairs.raw, weights.raw) };
#else
  return hn::VFromD<D>{ kBytes ? _mm512_maddubs_epi16(pairs.raw, weights.raw)
                               : _mm512_madd_epi16(pairs.raw, weights.raw) };
#endif
#else
  const auto first = hn::And(pairs, hn::Set(d, static_cast<Lane>((1U << kHalf) - 1)));
  return hn::Add(hn::Mul(first, hn::Set(d, even)),
                 hn::Mul(hn::ShiftRight<kHalf>(pairs), hn::Set(d, odd)));
#endif
}

template <class D, typename Sample>
HWY_INLINE hn::VFromD<D>
halved_sums(D d, const Sample *at)
{
  return hn::Add(hn::Add(weigh_pairs<1, 4>(d, at - 2), weigh_pairs<6, 4>(d, at)),
                 weigh_pairs<1, 0>(d, at + 2));
}

void
HalveColumns8(const std::uint8_t *row, int width, std::uint16_t *out, const std::uint8_t *ahead)
{
  halve_columns<std::uint16_t>(row, width, out,
                               [row, ahead](auto d, const std::uint8_t *at, std::uint16_t *halved)
                                   HWY_ATTR {
                                     hwy::Prefetch(ahead + (at - row));
                                     hn::StoreU(halved_sums(d, at), d, halved);
                                   });
}

void
HalveColumns16(const Fixed *row, int width, Fixed *out)
{
  halve_columns<std::uint32_t>(
      row, width, out, [](auto d, const Fixed *at, Fixed *halved) HWY_ATTR {
        const hn::RebindToSigned<decltype(d)> integers;
        const hn::Rebind<Fixed, decltype(d)> narrow;
        const auto mean = hn::ShiftRight<4>(halved_sums(d, at));
        hn::StoreU(hn::DemoteTo(narrow, hn::BitCast(integers, mean)), narrow, halved);
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
  halve_columns<float>(row, width, out, [](auto d, const float *at, float *halved) HWY_ATTR {
    hn::Vec<decltype(d)> v0, v1, v2, v3, v4, v5;
    hn::LoadInterleaved2(d, at - 2, v0, v1);
    hn::LoadInterleaved2(d, at, v2, v3);
    hn::LoadInterleaved2(d, at + 2, v4, v5);
    hn::StoreU(gaussian(d, v0, v1, v2, v3, v4), d, halved);
  });
}

void
HalveRowsOfSums(const std::array<const std::uint16_t *, 5> &rows, int count, Fixed *halved)
{
  cover<std::uint16_t>(count, [&](auto d, int x) HWY_ATTR {
    const auto center = hn::LoadU(d, rows[2] + x);
    const auto inner = hn::Add(hn::LoadU(d, rows[1] + x), hn::LoadU(d, rows[3] + x));
    const auto outer = hn::Add(hn::LoadU(d, rows[0] + x), hn::LoadU(d, rows[4] + x));
    const auto sum = hn::Add(hn::Add(outer, hn::Add(center, center)),
                             hn::ShiftLeft<2>(hn::Add(inner, center)));
    hn::StoreU(hn::AverageRound(sum, hn::Zero(d)), d, halved + x);
  });
}

void
HalveRows16(const std::array<const Fixed *, 5> &rows, int count, Fixed *halved)
{
  cover<Fixed>(count, [&](auto d, int x) HWY_ATTR {
    const auto center = hn::LoadU(d, rows[2] + x);
    const auto inner = hn::AverageRound(hn::LoadU(d, rows[1] + x), hn::LoadU(d, rows[3] + x));
    const auto outer = hn::AverageRound(hn::LoadU(d, rows[0] + x), hn::LoadU(d, rows[4] + x));
    // (outer + 3 center) / 4, which with as much of inner is the mean.
    const auto rest = hn::AverageRound(center, hn::AverageRound(center, outer));
    hn::StoreU(hn::AverageRound(inner, rest), d, halved + x);
  });
}

void
HalveRowsFloat(const std::array<const float *, 5> &rows, int count, float *halved)
{
  cover<float>(count, [&](auto d, int x) HWY_ATTR {
    hn::StoreU(gaussian(d, hn::LoadU(d, rows[0] + x), hn::LoadU(d, rows[1] + x),
                        hn::LoadU(d, rows[2] + x), hn::LoadU(d, rows[3] + x),
                        hn::LoadU(d, rows[4] + x)),
               d, halved + x);
  });
}

void
DoubleColumns(const Fixed *in, int width, Fixed *out)
{
  const int between = (width - 1) / 2; // samples of which there is one more
  cover<Fixed>(between, [&](auto d, int x) HWY_ATTR {
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
  cover<Fixed>(count, [&](auto d, int x) HWY_ATTR {
    hn::StoreU(hn::AverageRound(hn::LoadU(d, a + x), hn::LoadU(d, b + x)), d, out + x);
  });
}

void
ToFloat(const Fixed *in, int count, float scale, float offset, float *out)
{
  cover<float>(count, [&](auto d, int x) HWY_ATTR {
    const hn::RebindToSigned<decltype(d)> integers;
    const auto v = hn::LoadU(hn::Rebind<Fixed, decltype(d)>(), in + x);
    const auto scaled = hn::Mul(hn::ConvertTo(d, hn::PromoteTo(integers, v)), hn::Set(d, scale));
    hn::StoreU(hn::Add(scaled, hn::Set(d, offset)), d, out + x);
  });
}

} // namespace saliency::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saliency::kernels {

HWY_EXPORT(Unpack8);
HWY_EXPORT(Unpack16);
HWY_EXPORT(UnpackTriples);
HWY_EXPORT(Widen);
HWY_EXPORT(HalveColumns8);
HWY_EXPORT(HalveColumns16);
HWY_EXPORT(HalveColumnsFloat);
HWY_EXPORT(HalveRowsOfSums);
HWY_EXPORT(HalveRows16);
HWY_EXPORT(HalveRowsFloat);
HWY_EXPORT(DoubleColumns);
HWY_EXPORT(Average);
HWY_EXPORT(ToFloat);

void
unpack(const std::uint8_t *in, int stride, int count, std::uint8_t *out)
{
  HWY_DYNAMIC_DISPATCH(Unpack8)(in, stride, count, out);
}

void
unpack(const std::uint8_t *in, int stride, int left, unsigned mask, int count, Fixed *out)
{
  HWY_DYNAMIC_DISPATCH(Unpack16)(in, stride, left, mask, count, out);
}

void
unpack_triples(const std::uint8_t *in, int stride, int count,
               const std::array<std::uint8_t *, 3> &out, const std::uint8_t *ahead)
{
  HWY_DYNAMIC_DISPATCH(UnpackTriples)(in, stride, count, out, ahead);
}

void
widen(const std::uint8_t *in, int count, Fixed *out)
{
  HWY_DYNAMIC_DISPATCH(Widen)(in, count, out);
}

void
halve_columns(const std::uint8_t *row, int width, std::uint16_t *halved, const std::uint8_t *ahead)
{
  HWY_DYNAMIC_DISPATCH(HalveColumns8)(row, width, halved, ahead);
}

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
halve_rows_of_sums(const std::array<const std::uint16_t *, 5> &rows, int count, Fixed *halved)
{
  HWY_DYNAMIC_DISPATCH(HalveRowsOfSums)(rows, count, halved);
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

void
to_float(const Fixed *in, int count, float scale, float offset, float *out)
{
  HWY_DYNAMIC_DISPATCH(ToFloat)(in, count, scale, offset, out);
}

} // namespace saliency::kernels
#endif
