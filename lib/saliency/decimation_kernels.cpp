// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/decimation_kernels.h"

#include <algorithm>
#include <cstddef>

// Everything up to HWY_ONCE is compiled for each target. No fused multiply-add, which not all have.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "saliency/decimation_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "saliency/ahead-inl.h"
#include "saliency/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace saliency::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using saliency::HWY_NAMESPACE::ask;
using saliency::HWY_NAMESPACE::cover;
using saliency::HWY_NAMESPACE::load_bytes;
template <typename T> using Tag = saliency::HWY_NAMESPACE::Vectors<T>;

/// Places of a row that the Gaussian weighs by 1, 4, 6, 4 and 1.
using Taps = std::array<int, 5>;

/// Of the samples that `at(i)` gives, 16 times.
template <typename At>
auto
weigh_taps(const Taps &taps, const At &at)
{
  const auto &[i0, i1, i2, i3, i4] = taps;
  return at(i0) + at(i4) + 4 * (at(i1) + at(i3)) + 6 * at(i2);
}

/// Covers half of `width` places: the first and what `many(x)` leaves from place 1 on, which tells where
/// that begins, are `one(x, taps)` each.
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

/// From place x on, places by vectors of `step`: `work(x)` reads samples 2x - 2…2x + 2 step + 1 of
/// `readable`. The last goes over some places a second time.
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

/// The same, each place once: with shorter and shorter vectors. `work(d, x)`, of `numbers` a place.
template <int numbers, typename Work>
HWY_INLINE int
cover_halved_once(int x, [[maybe_unused]] int readable, [[maybe_unused]] const Work &work)
{
#if HWY_TARGET != HWY_SCALAR
  const auto by = [&x, readable, &work](auto d) HWY_ATTR {
    const int step = static_cast<int>(hn::Lanes(d)) / numbers;
    for (; 2 * (x + step) + 1 < readable; x += step)
      work(d, x);
  };
  by(Tag<std::uint16_t>());
  by(hn::CappedTag<std::uint16_t, 16>());
  by(hn::CappedTag<std::uint16_t, 8>());
#endif
  return x;
}

#if HWY_TARGET == HWY_SSSE3 || HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_AVX2                    \
    || HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
#define SALIENCY_WEIGHS_PAIRS 1 // by one instruction, which Highway 1.0 does not have

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

/// even × the first + odd × the second of each pair of numbers half as wide as a lane.
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

/// Five taps, `times` over, of each pair of numbers that `load(i)` gives, one for each lane, i pairs
/// further.
template <int times, class D, typename Load>
HWY_INLINE hn::VFromD<D>
halved_sums(D d, const Load &load)
{
  return hn::Add(hn::Add(weigh_pairs<times, 4 * times>(d, load(-1)),
                         weigh_pairs<6 * times, 4 * times>(d, load(0))),
                 weigh_pairs<times, 0>(d, load(1)));
}

/// Two more rows of sums from side to side, a and b, the first four times: the row that they complete
/// from top to bottom, and the sums for the next.
template <class D, class V = hn::VFromD<D>>
HWY_INLINE void
add_rows(D d, V four_a, V b, V &weighted, V &last, Fixed *halved)
{
  const auto sum = hn::Add(hn::Add(weighted, four_a), b);
  hn::StoreU(hn::AverageRound(sum, hn::Zero(d)), d, halved);
  weighted = hn::Add(hn::Add(last, four_a), hn::Mul(b, hn::Set(d, 6)));
  last = b;
}

HWY_INLINE void
add_rows(int four_a, int b, RowSums sums, std::ptrdiff_t x, Fixed *halved)
{
  *halved = static_cast<Fixed>((sums.weighted[x] + four_a + b + 1) / 2);
  sums.weighted[x] = static_cast<std::uint16_t>(sums.last[x] + four_a + 6 * b);
  sums.last[x] = static_cast<std::uint16_t>(b);
}

/// The rows at places x on, whose pairs `pairs(row)` gives for halved_sums(): row i to `halved(i)`.
template <class D, typename Pairs, typename Halved>
HWY_INLINE void
add_source_rows(D d, const SourceRows &rows, const Pairs &pairs, RowSums sums, std::ptrdiff_t x,
                const Halved &halved)
{
  auto weighted = hn::LoadU(d, sums.weighted + x);
  auto last = hn::LoadU(d, sums.last + x);
  for (std::size_t i = 0; i < kAtOnce; ++i)
    add_rows(d, halved_sums<4>(d, pairs(rows[2 * i])), halved_sums<1>(d, pairs(rows[2 * i + 1])),
             weighted, last, halved(i));
  hn::StoreU(weighted, d, sums.weighted + x);
  hn::StoreU(last, d, sums.last + x);
}

void
HalveBytes(SourceRows rows, int width, RowSums sums, AtOnce<Fixed *> halved, Ahead ahead)
{
  const auto work = [=](auto d, std::ptrdiff_t x) HWY_ATTR {
    const auto pairs = [d, x](const std::uint8_t *row) HWY_ATTR {
      return [d, at = row + 2 * x](std::ptrdiff_t i) HWY_ATTR {
        return load_bytes(d, at + 2 * i);
      };
    };
    ask<kSourceRows * 2 * hn::MaxLanes(d)>(ahead, kSourceRows * 2 * x);
    add_source_rows(d, rows, pairs, sums, x,
                    [halved, x](std::size_t i) HWY_ATTR { return halved[i] + x; });
  };
  const auto many = [width, &work](int x) HWY_ATTR {
    return cover_halved_once<1>(x, width, work);
  };
  for_halved(width, many, [&](int x, const Taps &taps) {
    const auto of = [&taps](const std::uint8_t *row) {
      return weigh_taps(taps, [row](int i) { return row[i]; });
    };
    for (std::size_t i = 0; i < kAtOnce; ++i)
      add_rows(4 * of(rows[2 * i]), of(rows[2 * i + 1]), sums, x, halved[i] + x);
  });
}

#if HWY_TARGET != HWY_SCALAR
/// Two pixels side by side have eight numbers, two of each kind: those of the first three kinds to rows of
/// their own.
void
part_pixels(const Fixed *pixels, std::ptrdiff_t count, const std::array<Fixed *, 3> &out,
            std::ptrdiff_t at)
{
  std::ptrdiff_t x = 0;
  const auto by = [=, &x](auto d) HWY_ATTR {
    const hn::Repartition<Fixed, decltype(d)> d16; // of each kind, as pairs go together
    const auto step = static_cast<std::ptrdiff_t>(hn::Lanes(d16));
    for (; x + step <= count; x += step) {
      const auto kinds = [=](std::ptrdiff_t i) HWY_ATTR {
        return load_bytes(d, pixels + 4 * x + i * step);
      };
      const auto v0 = kinds(0);
      const auto v1 = kinds(1);
      const auto v2 = kinds(2);
      const auto v3 = kinds(3);
      const auto low_even = hn::ConcatEven(d, v1, v0);
      const auto high_even = hn::ConcatEven(d, v3, v2);
      const auto low_odd = hn::ConcatOdd(d, v1, v0);
      const auto high_odd = hn::ConcatOdd(d, v3, v2);
      const auto store = [=](auto kind, std::size_t c) HWY_ATTR {
        hn::StoreU(hn::BitCast(d16, kind), d16, out[c] + at + x);
      };
      store(hn::ConcatEven(d, high_even, low_even), 0);
      store(hn::ConcatEven(d, high_odd, low_odd), 1);
      store(hn::ConcatOdd(d, high_even, low_even), 2);
    }
  };
  by(Tag<std::uint32_t>());
  by(hn::CappedTag<std::uint32_t, 4>());
  for (; x < count; ++x)
    for (std::size_t c = 0; c < 3; ++c)
      out[c][at + x] = pixels[8 * (x / 2) + 2 * static_cast<std::ptrdiff_t>(c) + x % 2];
}

/// Pixels are taken apart a few at a time, while they are in the first level of the cache. Vectors stop
/// short of the last pixel, of which there may be three bytes alone.
int
halve_pixels_from(int x, SourceRows rows, int width, RowSums sums,
                  const AtOnce<std::array<Fixed *, 3>> &halved, Ahead ahead)
{
  alignas(16) static constexpr std::array<std::uint8_t, 16> kPairs
      = { 0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15 };
  constexpr int kPixels = 32;
  alignas(64) AtOnce<std::array<Fixed, std::size_t{ 4 } * kPixels>> pixels;
  std::ptrdiff_t begin = x; // place of the first of the pixels
  const auto part = [&](std::ptrdiff_t count) {
    for (std::size_t i = 0; i < kAtOnce; ++i)
      part_pixels(pixels[i].data(), count, halved[i], begin);
    begin += count;
  };
  const int end = cover_halved_once<4>(
      x, width - 1, [=, &part, &pixels, &begin](auto d, std::ptrdiff_t place) HWY_ATTR {
        const hn::Repartition<std::uint8_t, decltype(d)> d8;
        const auto order = hn::LoadDup128(d8, kPairs.data());
        const auto pairs = [d, d8, order, place](const std::uint8_t *row) HWY_ATTR {
          return [d, d8, order, at = row + 8 * place](std::ptrdiff_t i) HWY_ATTR {
            return hn::BitCast(d, hn::TableLookupBytes(hn::LoadU(d8, at + 8 * i), order));
          };
        };
        ask<kSourceRows * 2 * hn::MaxLanes(d)>(ahead, kSourceRows * 8 * place);
        add_source_rows(d, rows, pairs, sums, 4 * place, [&](std::size_t i) HWY_ATTR {
          return pixels[i].data() + 4 * (place - begin);
        });
        if (place + static_cast<std::ptrdiff_t>(hn::Lanes(d)) / 4 == begin + kPixels)
          part(kPixels);
      });
  part(end - begin);
  return end;
}
#endif

void
HalvePixels(const SourceRows &rows, int width, const RowSums &sums,
            const AtOnce<std::array<Fixed *, 3>> &halved, const Ahead &ahead)
{
  const auto many = [&](int x) HWY_ATTR {
#if HWY_TARGET == HWY_SCALAR
    static_cast<void>(ahead);
    return x;
#else
    return halve_pixels_from(x, rows, width, sums, halved, ahead);
#endif
  };
  for_halved(width, many, [&](int x, const Taps &taps) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto of = [&taps, c](const std::uint8_t *row) {
        return weigh_taps(taps, [at = row + c](std::ptrdiff_t i) { return at[4 * i]; });
      };
      for (std::size_t i = 0; i < kAtOnce; ++i)
        add_rows(4 * of(rows[2 * i]), of(rows[2 * i + 1]), sums,
                 4 * std::ptrdiff_t{ x } + static_cast<std::ptrdiff_t>(c), halved[i][c] + x);
    }
  });
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
    const auto center = hn::LoadU(d, rows[2] + x);
    const auto inner = hn::AverageRound(hn::LoadU(d, rows[1] + x), hn::LoadU(d, rows[3] + x));
    const auto outer = hn::AverageRound(hn::LoadU(d, rows[0] + x), hn::LoadU(d, rows[4] + x));
    // (outer + 3 center) / 4, which with as much of inner is the mean.
    const auto rest = hn::AverageRound(center, hn::AverageRound(center, outer));
    hn::StoreU(hn::AverageRound(inner, rest), d, halved + x);
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
  const int between = (width - 1) / 2; // samples of which there is one more
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

HWY_EXPORT(HalveBytes);
HWY_EXPORT(HalvePixels);
HWY_EXPORT(HalveColumns16);
HWY_EXPORT(HalveColumnsFloat);
HWY_EXPORT(HalveRows16);
HWY_EXPORT(HalveRowsFloat);
HWY_EXPORT(DoubleColumns);
HWY_EXPORT(Average);

void
halve_bytes(const SourceRows &rows, int width, const RowSums &sums, const AtOnce<Fixed *> &halved,
            const Ahead &ahead)
{
  HWY_DYNAMIC_DISPATCH(HalveBytes)(rows, width, sums, halved, ahead);
}

void
halve_pixels(const SourceRows &rows, int width, const RowSums &sums,
             const AtOnce<std::array<Fixed *, 3>> &halved, const Ahead &ahead)
{
  HWY_DYNAMIC_DISPATCH(HalvePixels)(rows, width, sums, halved, ahead);
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
