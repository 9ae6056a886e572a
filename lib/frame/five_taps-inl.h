// SPDX-License-Identifier: LGPL-2.1-or-later
// Code of the kernels that halve rows, in sources that Highway compiles once per target.
#if defined(SALIENCY_FIVE_TAPS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SALIENCY_FIVE_TAPS_INL_H
#undef SALIENCY_FIVE_TAPS_INL_H
#else
#define SALIENCY_FIVE_TAPS_INL_H
#endif

#include "frame/image_rows.h"

#include <hwy/highway.h>

#include <array>
#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace saliency::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Indices of the five samples under the kernel [1 4 6 4 1].
using Taps = std::array<int, 5>;

/// The weighted sum of the samples `at(i)`: 16 times their mean.
template <typename At>
auto
weigh_taps(const Taps &taps, const At &at)
{
  const auto &[i0, i1, i2, i3, i4] = taps;
  return at(i0) + at(i4) + 4 * (at(i1) + at(i3)) + 6 * at(i2);
}

/// Covers all (width + 1) / 2 outputs of a row. `many(1)` makes outputs from 1 on by vectors and
/// returns where it stopped; output 0 and the rest are made by `one(x, taps)`.
template <typename Many, typename One>
HWY_INLINE void
for_halved(int width, const Many &many, const One &one)
{
  const int end = (width + 1) / 2;
  if (width < 5) {
    for (int x = 0; x < end; ++x) {
      Taps taps;
      for (int i = 0; i < 5; ++i)
        taps[static_cast<std::size_t>(i)] = mirrored(2 * x - 2 + i, width);
      one(x, taps);
    }
    return;
  }
  one(0, { 2, 1, 0, 1, 2 });
  int x = many(1);
  for (; x + 1 < end; ++x)
    one(x, { 2 * x - 2, 2 * x - 1, 2 * x, 2 * x + 1, 2 * x + 2 });
  if (width % 2 == 0)
    one(x, { 2 * x - 2, 2 * x - 1, 2 * x, 2 * x + 1, 2 * x });
  else
    one(x, { 2 * x - 2, 2 * x - 1, 2 * x, 2 * x - 1, 2 * x - 2 });
}

#if HWY_TARGET == HWY_SSSE3 || HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_AVX2                    \
    || HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
#define SALIENCY_WEIGHS_PAIRS 1 // in one instruction, which Highway 1.0 lacks

template <bool bytes>
HWY_INLINE __m128i
weigh(__m128i pairs, __m128i weights)
{
  return bytes ? _mm_maddubs_epi16(pairs, weights) : _mm_madd_epi16(pairs, weights);
}

#if HWY_TARGET <= HWY_AVX2
template <bool bytes>
HWY_INLINE __m256i
weigh(__m256i pairs, __m256i weights)
{
  return bytes ? _mm256_maddubs_epi16(pairs, weights) : _mm256_madd_epi16(pairs, weights);
}
#endif

#if HWY_TARGET <= HWY_AVX3
template <bool bytes>
HWY_INLINE __m512i
weigh(__m512i pairs, __m512i weights)
{
  return bytes ? _mm512_maddubs_epi16(pairs, weights) : _mm512_madd_epi16(pairs, weights);
}
#endif

#else
#define SALIENCY_WEIGHS_PAIRS 0
#endif

/// even × first + odd × second of each pair of half-width numbers in a lane.
template <int even, int odd, class D>
HWY_INLINE hn::VFromD<D>
weigh_pairs(D d, hn::VFromD<D> pairs)
{
  using Lane = hn::TFromD<D>;
  constexpr int kHalf = 4 * sizeof(Lane); // bits
#if SALIENCY_WEIGHS_PAIRS
  const auto weights = hn::Set(d, static_cast<Lane>(even | odd << kHalf));
  return hn::VFromD<D>{ weigh<sizeof(Lane) == 2>(pairs.raw, weights.raw) };
#else
  const auto first = hn::And(pairs, hn::Set(d, static_cast<Lane>((1U << kHalf) - 1)));
  return hn::Add(hn::Mul(first, hn::Set(d, even)),
                 hn::Mul(hn::ShiftRight<kHalf>(pairs), hn::Set(d, odd)));
#endif
}
#undef SALIENCY_WEIGHS_PAIRS

/// `times` the five-tap sum of each lane. `load(i)` returns the samples in pairs, one pair per
/// lane, starting i pairs further on.
template <int times, class D, typename Load>
HWY_INLINE hn::VFromD<D>
halved_sums(D d, const Load &load)
{
  return hn::Add(hn::Add(weigh_pairs<times, 4 * times>(d, load(-1)),
                         weigh_pairs<6 * times, 4 * times>(d, load(0))),
                 weigh_pairs<times, 0>(d, load(1)));
}

HWY_INLINE int
average(int a, int b)
{
  return (a + b + 1) / 2;
}

template <class V>
HWY_INLINE V
average(V a, V b)
{
  return hn::AverageRound(a, b);
}

/// [1 4 6 4 1]/16 from pairwise means.
template <class V>
HWY_INLINE V
mean_of_five(V v0, V v1, V v2, V v3, V v4)
{
  // (outer + 3 center) / 4, whose mean with the inner taps is the result.
  const V rest = average(v2, average(v2, average(v0, v4)));
  return average(average(v1, v3), rest);
}

} // namespace saliency::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
