// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame/byte_kernels.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

// Everything up to HWY_ONCE is compiled once per target, without FMA: results are bit-identical.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "frame/byte_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "frame/five_taps-inl.h"
#include "frame/prefetch-inl.h"
#include "frame/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace saliency::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using saliency::HWY_NAMESPACE::average;
using saliency::HWY_NAMESPACE::for_halved;
using saliency::HWY_NAMESPACE::halved_sums;
using saliency::HWY_NAMESPACE::load_bytes;
using saliency::HWY_NAMESPACE::mean_of_five;
using saliency::HWY_NAMESPACE::prefetch;
using saliency::HWY_NAMESPACE::Taps;
using saliency::HWY_NAMESPACE::weigh_taps;
template <typename T> using Tag = saliency::HWY_NAMESPACE::Vectors<T>;

/// Covers output indices from x on, whose input lies in `readable` samples, once each, with ever
/// shorter vectors. Calls `work(d, x)`; each index has `numbers` lanes. Returns where it stopped.
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
  if constexpr (numbers == 1) {
    by(hn::CappedTag<std::uint16_t, 4>());
    by(hn::CappedTag<std::uint16_t, 2>());
  }
#endif
  return x;
}

/// Stands for a vector's tag: one number at a time, faster at the ends of a row.
struct One
{
};

HWY_INLINE int
load(One, const std::uint16_t *from)
{
  return *from;
}

template <class D>
HWY_INLINE hn::VFromD<D>
load(D d, const std::uint16_t *from)
{
  return hn::LoadU(d, from);
}

HWY_INLINE void
store(int value, One, std::uint16_t *to)
{
  *to = static_cast<std::uint16_t>(value);
}

template <class D>
HWY_INLINE void
store(hn::VFromD<D> value, D d, std::uint16_t *to)
{
  hn::StoreU(value, d, to);
}

/// 6, hidden from the compiler, which would replace one multiplication by two shifts and an
/// addition.
HWY_INLINE std::uint16_t
six()
{
  std::uint16_t value = 6;
#ifdef __GNUC__
  asm("" : "+r"(value));
#endif
  return value;
}

/// Adds two rows of horizontal sums, a (times 4) and b. Returns the row that they complete
/// vertically and updates the sums for the next.
template <class D, class V = hn::VFromD<D>>
HWY_INLINE V
add_rows(D d, V four_a, V b, V &weighted, V &last)
{
  const V halved = hn::AverageRound(hn::Add(weighted, four_a), b);
  weighted = hn::Add(hn::Add(last, four_a), hn::Mul(b, hn::Set(d, six())));
  last = b;
  return halved;
}

HWY_INLINE int
add_rows(One, int four_a, int b, int &weighted, int &last)
{
  const int sum = weighted + four_a + b;
  weighted = last + four_a + 6 * b;
  last = b;
  return average(sum, 0);
}

/// Halving: stores both rows at `out(0)` and `out(1)`. Its carried state has the sums alone.
struct Halved
{
  static constexpr std::size_t kRows = kAtOnce;
  static constexpr int kKinds = Carried::kHalved;

  template <class D, class V, typename Out>
  static HWY_INLINE void store_rows(D d, V v0, V v1, std::uint16_t *, int, const Out &out)
  {
    store(v0, d, out(0));
    store(v1, d, out(1));
  }
};

/// Quartering: stores one row, made from these two and the three rows kept before.
struct Quartered
{
  static constexpr std::size_t kRows = 1;
  static constexpr int kKinds = Carried::kQuartered;

  template <class D, class V, typename Out>
  static HWY_INLINE void store_rows(D d, V v3, V v4, std::uint16_t *carried, int more,
                                    const Out &out)
  {
    std::uint16_t *const kept = carried + 2 * Carried::kBlock;
    const V v0 = load(d, kept);
    const V v1 = load(d, kept + Carried::kBlock);
    const V v2 = load(d, kept + 2 * Carried::kBlock);
    if (HWY_UNLIKELY(more < 2)) {
      v3 = more == 1 ? v3 : v1;
      v4 = more == 1 ? v2 : v0;
    }
    store(v2, d, kept);
    store(v3, d, kept + Carried::kBlock);
    store(v4, d, kept + 2 * Carried::kBlock);
    store(mean_of_five(v0, v1, v2, v3, v4), d, out(0));
  }
};

/// Adds four source rows at carried number `x`. `four(row)` and `once(row)` return a row's
/// horizontal sum, times four and times one.
template <class Made, class D, typename Four, typename Once, typename Out>
HWY_INLINE void
add_source_rows(D d, const SourceRows &rows, const Four &four, const Once &once, Carried carried,
                std::size_t x, const Out &out)
{
  static_assert(kAtOnce == 2);
  constexpr std::size_t kBlock = Carried::kBlock;
  std::uint16_t *const sums = carried.first + x / kBlock * (kBlock * Made::kKinds) + x % kBlock;
  auto weighted = load(d, sums);
  auto last = load(d, sums + kBlock);
  const auto v0 = add_rows(d, four(rows[0]), once(rows[1]), weighted, last);
  const auto v1 = add_rows(d, four(rows[2]), once(rows[3]), weighted, last);
  store(weighted, d, sums);
  store(last, d, sums + kBlock);
  Made::store_rows(d, v0, v1, sums, carried.more, out);
}

/// The same by vectors, which `pairs(row)` loads for halved_sums().
template <class Made, class D, typename Pairs, typename Out>
HWY_INLINE void
add_source_pairs(D d, const SourceRows &rows, const Pairs &pairs, Carried carried, std::size_t x,
                 const Out &out)
{
  const auto four = [=](const std::uint8_t *row) HWY_ATTR {
    return halved_sums<4>(d, pairs(row));
  };
  const auto once = [=](const std::uint8_t *row) HWY_ATTR {
    return halved_sums<1>(d, pairs(row));
  };
  add_source_rows<Made>(d, rows, four, once, carried, x, out);
}

/// The same for a single output; `at(row, i)` returns byte i of a row.
template <class Made, typename At, typename Out>
HWY_INLINE void
add_source_taps(const SourceRows &rows, const Taps &taps, const At &at, Carried carried,
                std::size_t x, const Out &out)
{
  const auto once = [&taps, &at](const std::uint8_t *row) {
    return weigh_taps(taps, [row, &at](int i) { return at(row, i); });
  };
  add_source_rows<Made>(
      One(), rows, [&once](const std::uint8_t *row) { return 4 * once(row); }, once, carried, x,
      out);
}

/// Index of the first carried number of an output.
template <std::size_t numbers>
constexpr std::size_t
carried_at(std::ptrdiff_t place)
{
  return static_cast<std::size_t>(place) * numbers + (Carried::kBlock - numbers);
}

template <class Made>
HWY_INLINE void
decimate_bytes(SourceRows rows, int width, Carried carried, std::array<Fixed *, Made::kRows> out,
               Prefetch ahead)
{
  const auto at = [out](std::ptrdiff_t x) {
    return [out, x](std::size_t i) {
      return out[i] + x;
    };
  };
  const auto work = [=](auto d, std::ptrdiff_t x) HWY_ATTR {
    const auto pairs = [d, x](const std::uint8_t *row) HWY_ATTR {
      return [d, at = row + 2 * x](std::ptrdiff_t i) HWY_ATTR {
        return load_bytes(d, at + 2 * i);
      };
    };
    prefetch<kSourceRows * 2 * hn::MaxLanes(d)>(ahead, kSourceRows * 2 * x);
    add_source_pairs<Made>(d, rows, pairs, carried, carried_at<1>(x), at(x));
  };
  const auto many = [width, &work](int x) HWY_ATTR {
    return cover_halved_once<1>(x, width, work);
  };
  const auto one = [=](int x, const Taps &taps) HWY_ATTR {
    add_source_taps<Made>(
        rows, taps, [](const std::uint8_t *row, int i) { return row[i]; }, carried,
        carried_at<1>(x), at(x));
  };
  for_halved(width, many, one);
}

void
HalveBytes(const SourceRows &rows, int width, const Carried &carried, const AtOnce<Fixed *> &halved,
           const Prefetch &ahead)
{
  decimate_bytes<Halved>(rows, width, carried, halved, ahead);
}

void
QuarterBytes(const SourceRows &rows, int width, const Carried &carried, Fixed *quartered,
             const Prefetch &ahead)
{
  decimate_bytes<Quartered>(rows, width, carried, { quartered }, ahead);
}

/// One row for each component used: two for pixels of two bytes, three for four.
template <int bytes> using Kinds = std::array<Fixed *, bytes == 2 ? 2 : 3>;

#if HWY_TARGET != HWY_SCALAR
/// Splits `count` pixels into a row per component. Each 16 bytes of `pixels` hold a few pixels,
/// sorted by component.
template <int bytes>
void
part_pixels(const Fixed *pixels, std::ptrdiff_t count, const Kinds<bytes> &out, std::ptrdiff_t at)
{
  std::ptrdiff_t x = 0;
  const auto by = [=, &x](auto d) HWY_ATTR { // a lane holds the adjacent numbers of one component
    const hn::Repartition<Fixed, decltype(d)> d16;
    const auto step = static_cast<std::ptrdiff_t>(hn::Lanes(d16));
    for (; x + step <= count; x += step) {
      const auto kinds = [=](std::ptrdiff_t i) HWY_ATTR {
        return load_bytes(d, pixels + bytes * x + i * step);
      };
      const auto store = [=](auto kind, std::size_t c) HWY_ATTR {
        hn::StoreU(hn::BitCast(d16, kind), d16, out[c] + at + x);
      };
      const auto v0 = kinds(0);
      const auto v1 = kinds(1);
      const auto low_even = hn::ConcatEven(d, v1, v0);
      const auto low_odd = hn::ConcatOdd(d, v1, v0);
      if constexpr (bytes == 2) {
        store(low_even, 0);
        store(low_odd, 1);
      } else {
        const auto v2 = kinds(2);
        const auto v3 = kinds(3);
        const auto high_even = hn::ConcatEven(d, v3, v2);
        const auto high_odd = hn::ConcatOdd(d, v3, v2);
        store(hn::ConcatEven(d, high_even, low_even), 0);
        store(hn::ConcatEven(d, high_odd, low_odd), 1);
        store(hn::ConcatOdd(d, high_even, low_even), 2);
      }
    }
  };
  using Lane = std::conditional_t<bytes == 2, std::uint64_t, std::uint32_t>;
  by(Tag<Lane>());
  by(hn::CappedTag<Lane, 16 / sizeof(Lane)>());
  constexpr std::ptrdiff_t kTogether = 8 / bytes;
  for (; x < count; ++x)
    for (std::size_t c = 0; c < out.size(); ++c)
      out[c][at + x] = pixels[8 * (x / kTogether) + kTogether * static_cast<std::ptrdiff_t>(c)
                              + x % kTogether];
}

/// Pixels are split a few at a time while they are in the L1 cache. Vectors stop before the last
/// four-byte pixel, of which only three bytes may exist.
template <class Made, int bytes>
int
decimate_pixels_from(int x, const SourceRows &rows, int width, Carried carried,
                     const std::array<Kinds<bytes>, Made::kRows> &out, Prefetch ahead)
{
  alignas(16) static constexpr std::array<std::uint8_t, 16> kPairs
      = bytes == 2
            ? std::array<std::uint8_t, 16>{ 0, 2, 4, 6, 8, 10, 12, 14, 1, 3, 5, 7, 9, 11, 13, 15 }
            : std::array<std::uint8_t, 16>{ 0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15 };
  constexpr int kPlaces = 32;
  alignas(64) std::array<std::array<Fixed, std::size_t{ bytes } * kPlaces>, Made::kRows> pixels;
  std::ptrdiff_t begin = x; // first output of `pixels`
  const auto part = [&](std::ptrdiff_t count) {
    for (std::size_t i = 0; i < Made::kRows; ++i)
      part_pixels<bytes>(pixels[i].data(), count, out[i], begin);
    begin += count;
  };
  const int end = cover_halved_once<bytes>(
      x, bytes == 4 ? width - 1 : width,
      [=, &part, &pixels, &begin](auto d, std::ptrdiff_t place) HWY_ATTR {
        const hn::Repartition<std::uint8_t, decltype(d)> d8;
        const auto pairs = [d, d8, place](const std::uint8_t *row) HWY_ATTR {
          return [d, d8, at = row + 2 * place * bytes](std::ptrdiff_t i) HWY_ATTR {
            const auto order
                = hn::LoadDup128(d8, kPairs.data()); // lambdas cannot hold vectors of SVE
            return hn::BitCast(d, hn::TableLookupBytes(hn::LoadU(d8, at + 2 * i * bytes), order));
          };
        };
        prefetch<kSourceRows * 2 * hn::MaxLanes(d)>(ahead, kSourceRows * 2 * bytes * place);
        add_source_pairs<Made>(d, rows, pairs, carried, carried_at<bytes>(place),
                               [&](std::size_t i)
                                   HWY_ATTR { return pixels[i].data() + bytes * (place - begin); });
        if (place + static_cast<std::ptrdiff_t>(hn::Lanes(d)) / bytes == begin + kPlaces)
          part(kPlaces);
      });
  part(end - begin);
  return end;
}
#endif

template <class Made, int bytes>
HWY_INLINE void
decimate_pixels(const SourceRows &rows, int width, const Carried &carried,
                const std::array<Kinds<bytes>, Made::kRows> &out, const Prefetch &ahead)
{
  const auto many = [&](int x) HWY_ATTR {
#if HWY_TARGET == HWY_SCALAR
    static_cast<void>(ahead);
    return x;
#else
    return decimate_pixels_from<Made, bytes>(x, rows, width, carried, out, ahead);
#endif
  };
  const auto one = [&](int x, const Taps &taps) HWY_ATTR {
    for (std::size_t c = 0; c < Kinds<bytes>().size(); ++c)
      add_source_taps<Made>(
          rows, taps, [c](const std::uint8_t *row, std::ptrdiff_t i) { return row[bytes * i + c]; },
          carried, carried_at<bytes>(x) + c, [&](std::size_t i) { return out[i][c] + x; });
  };
  for_halved(width, many, one);
}

void
HalvePairs(const SourceRows &rows, int width, const Carried &carried,
           const AtOnce<std::array<Fixed *, 2>> &halved, const Prefetch &ahead)
{
  decimate_pixels<Halved, 2>(rows, width, carried, halved, ahead);
}

void
HalvePixels(const SourceRows &rows, int width, const Carried &carried,
            const AtOnce<std::array<Fixed *, 3>> &halved, const Prefetch &ahead)
{
  decimate_pixels<Halved, 4>(rows, width, carried, halved, ahead);
}

void
QuarterPairs(const SourceRows &rows, int width, const Carried &carried,
             const std::array<Fixed *, 2> &quartered, const Prefetch &ahead)
{
  decimate_pixels<Quartered, 2>(rows, width, carried, { quartered }, ahead);
}

void
QuarterPixels(const SourceRows &rows, int width, const Carried &carried,
              const std::array<Fixed *, 3> &quartered, const Prefetch &ahead)
{
  decimate_pixels<Quartered, 4>(rows, width, carried, { quartered }, ahead);
}

} // namespace saliency::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saliency::kernels {

HWY_EXPORT(HalveBytes);
HWY_EXPORT(HalvePairs);
HWY_EXPORT(HalvePixels);
HWY_EXPORT(QuarterBytes);
HWY_EXPORT(QuarterPairs);
HWY_EXPORT(QuarterPixels);

void
halve_bytes(const SourceRows &rows, int width, const Carried &carried,
            const AtOnce<Fixed *> &halved, const Prefetch &ahead)
{
  HWY_DYNAMIC_DISPATCH(HalveBytes)(rows, width, carried, halved, ahead);
}

void
halve_pixels(const SourceRows &rows, int width, const Carried &carried,
             const AtOnce<std::array<Fixed *, 2>> &halved, const Prefetch &ahead)
{
  HWY_DYNAMIC_DISPATCH(HalvePairs)(rows, width, carried, halved, ahead);
}

void
halve_pixels(const SourceRows &rows, int width, const Carried &carried,
             const AtOnce<std::array<Fixed *, 3>> &halved, const Prefetch &ahead)
{
  HWY_DYNAMIC_DISPATCH(HalvePixels)(rows, width, carried, halved, ahead);
}

void
quarter_bytes(const SourceRows &rows, int width, const Carried &carried, Fixed *quartered,
              const Prefetch &ahead)
{
  HWY_DYNAMIC_DISPATCH(QuarterBytes)(rows, width, carried, quartered, ahead);
}

void
quarter_pixels(const SourceRows &rows, int width, const Carried &carried,
               const std::array<Fixed *, 2> &quartered, const Prefetch &ahead)
{
  HWY_DYNAMIC_DISPATCH(QuarterPairs)(rows, width, carried, quartered, ahead);
}

void
quarter_pixels(const SourceRows &rows, int width, const Carried &carried,
               const std::array<Fixed *, 3> &quartered, const Prefetch &ahead)
{
  HWY_DYNAMIC_DISPATCH(QuarterPixels)(rows, width, carried, quartered, ahead);
}

} // namespace saliency::kernels
#endif
