// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/front_end_kernels.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

// Everything up to HWY_ONCE is compiled for each target. No fused multiply-add, which not all have.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "saliency/front_end_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace saliency::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <typename T> using Tag = hn::CappedTag<T, 64 / sizeof(T)>;

/// Lanes from memory that need not be aligned for them: as many samples of less width as fit.
template <class D>
HWY_INLINE hn::VFromD<D>
load_bytes(D d, const void *bytes)
{
#if HWY_TARGET == HWY_SCALAR
  hn::TFromD<D> lane;
  std::memcpy(&lane, bytes, sizeof lane);
  return hn::Set(d, lane);
#else
  const hn::Repartition<std::uint8_t, D> d8;
  return hn::BitCast(d, hn::LoadU(d8, static_cast<const std::uint8_t *>(bytes)));
#endif
}

/// Unsigned lanes to half their width, which their values fit.
template <class D, typename Narrow = hwy::MakeNarrow<hn::TFromD<D>>>
HWY_INLINE hn::VFromD<hn::Rebind<Narrow, D>>
narrow(D, hn::VFromD<D> v)
{
  return hn::DemoteTo(hn::Rebind<Narrow, D>(), hn::BitCast(hn::RebindToSigned<D>(), v));
}

void
Unpack8(const std::uint8_t *in, int stride, int count, std::uint8_t *out)
{
  if (stride == 1) {
    std::memcpy(out, in, static_cast<std::size_t>(count));
    return;
  }
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
  } else if (stride == 3) {
    for (; x + step < count; x += step) {
      hn::Vec<decltype(d)> sample, second, third;
      hn::LoadInterleaved3(d, in + static_cast<std::ptrdiff_t>(x) * 3, sample, second, third);
      hn::StoreU(sample, d, out + x);
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
Unpack16(const std::uint8_t *in, int stride, int shift, unsigned mask, int count,
         std::uint16_t *out)
{
  int x = 0;
  if (stride == 2) {
    const Tag<std::uint16_t> d;
    const int step = static_cast<int>(hn::Lanes(d));
    const auto bits = hn::Set(d, static_cast<std::uint16_t>(mask));
    for (; x + step <= count; x += step) {
      const auto words = load_bytes(d, in + static_cast<std::ptrdiff_t>(x) * 2);
      hn::StoreU(hn::And(hn::ShiftRightSame(words, shift), bits), d, out + x);
    }
  }
#if HWY_TARGET != HWY_SCALAR
  if (stride == 4) {
    const Tag<std::uint16_t> d;
    const int step = static_cast<int>(hn::Lanes(d));
    const auto bits = hn::Set(d, static_cast<std::uint16_t>(mask));
    for (; x + step < count; x += step) {
      const auto *at = in + static_cast<std::ptrdiff_t>(x) * 4;
      const auto words = hn::ConcatEven(d, load_bytes(d, at + 2 * step), load_bytes(d, at));
      hn::StoreU(hn::And(hn::ShiftRightSame(words, shift), bits), d, out + x);
    }
  }
#endif
  for (; x < count; ++x) {
    const auto *word = in + static_cast<std::ptrdiff_t>(x) * stride;
    out[x] = static_cast<std::uint16_t>((static_cast<unsigned>(word[0] | word[1] << 8) >> shift)
                                        & mask);
  }
}

/// Two samples before the first and two after the last, without repeating those.
template <typename T>
void
mirror_ends(T *row, int width)
{
  const int last = width - 1;
  row[-1] = row[std::min(1, last)];
  row[-2] = row[last > 1 ? 2 : 0];
  row[width] = row[std::max(0, last - 1)];
  row[width + 1] = row[last > 1 ? last - 2 : last];
}

/// Pairs of samples as lanes twice as wide: an even sample is the lower half, an odd one the upper.
template <typename Sample, typename Sum>
void
halve_integer_columns(Sample *row, int width, Sum *halved)
{
  mirror_ends(row, width);
  constexpr int kBits = 8 * sizeof(Sample);
  const Tag<Sum> d;
  const int step = static_cast<int>(hn::Lanes(d));
  const auto mask = hn::Set(d, static_cast<Sum>((1U << kBits) - 1));
  for (int x = 0; 2 * x < width; x += step) {
    const auto before = load_bytes(d, row + 2 * x - 2);
    const auto here = load_bytes(d, row + 2 * x);
    const auto after = load_bytes(d, row + 2 * x + 2);
    const auto center = hn::And(here, mask);
    const auto odd = hn::Add(hn::ShiftRight<kBits>(before), hn::ShiftRight<kBits>(here));
    const auto even = hn::Add(hn::And(before, mask), hn::And(after, mask));
    // 1, 4, 6 = 4 + 2
    hn::StoreU(
        hn::Add(hn::Add(even, hn::Add(center, center)), hn::ShiftLeft<2>(hn::Add(odd, center))), d,
        halved + x);
  }
}

void
HalveColumns8(std::uint8_t *row, int width, std::uint16_t *halved)
{
  halve_integer_columns(row, width, halved);
}

void
HalveColumns16(std::uint16_t *row, int width, std::uint32_t *halved)
{
  halve_integer_columns(row, width, halved);
}

template <class D>
HWY_INLINE hn::VFromD<D>
gaussian(D d, hn::VFromD<D> v0, hn::VFromD<D> v1, hn::VFromD<D> v2, hn::VFromD<D> v3,
         hn::VFromD<D> v4)
{
  const auto outer = hn::Add(hn::Add(v0, v4), hn::Mul(hn::Set(d, 4.0F), hn::Add(v1, v3)));
  return hn::Mul(hn::Add(outer, hn::Mul(hn::Set(d, 6.0F), v2)), hn::Set(d, 1.0F / 16));
}

void
HalveColumnsFloat(float *row, int width, float *halved)
{
  mirror_ends(row, width);
  const Tag<float> d;
  const int step = static_cast<int>(hn::Lanes(d));
  for (int x = 0; 2 * x < width; x += step) {
    hn::Vec<decltype(d)> v0, v1, v2, v3, v4, v5;
    hn::LoadInterleaved2(d, row + 2 * x - 2, v0, v1);
    hn::LoadInterleaved2(d, row + 2 * x, v2, v3);
    hn::LoadInterleaved2(d, row + 2 * x + 2, v4, v5);
    hn::StoreU(gaussian(d, v0, v1, v2, v3, v4), d, halved + x);
  }
}

template <typename Sum, typename Sample>
void
halve_integer_rows(const std::array<const Sum *, 5> &rows, int count, Sample *halved)
{
  const Tag<Sum> d;
  const int step = static_cast<int>(hn::Lanes(d));
  const auto half = hn::Set(d, Sum{ 128 });
  for (int x = 0; x < count; x += step) {
    const auto center = hn::LoadU(d, rows[2] + x);
    const auto inner = hn::Add(hn::LoadU(d, rows[1] + x), hn::LoadU(d, rows[3] + x));
    const auto outer = hn::Add(hn::LoadU(d, rows[0] + x), hn::LoadU(d, rows[4] + x));
    const auto sum = hn::Add(hn::Add(outer, hn::Add(center, center)),
                             hn::ShiftLeft<2>(hn::Add(inner, center)));
    hn::StoreU(narrow(d, hn::ShiftRight<8>(hn::Add(sum, half))), hn::Rebind<Sample, decltype(d)>(),
               halved + x);
  }
}

void
HalveRows8(const std::array<const std::uint16_t *, 5> &rows, int count, std::uint8_t *halved)
{
  halve_integer_rows(rows, count, halved);
}

void
HalveRows16(const std::array<const std::uint32_t *, 5> &rows, int count, std::uint16_t *halved)
{
  halve_integer_rows(rows, count, halved);
}

void
HalveRowsFloat(const std::array<const float *, 5> &rows, int count, float *halved)
{
  const Tag<float> d;
  const int step = static_cast<int>(hn::Lanes(d));
  for (int x = 0; x < count; x += step)
    hn::StoreU(gaussian(d, hn::LoadU(d, rows[0] + x), hn::LoadU(d, rows[1] + x),
                        hn::LoadU(d, rows[2] + x), hn::LoadU(d, rows[3] + x),
                        hn::LoadU(d, rows[4] + x)),
               d, halved + x);
}

template <typename T>
void
integers_to_float(const T *in, int count, float *out)
{
  const Tag<float> d;
  const hn::RebindToSigned<decltype(d)> integers;
  const int step = static_cast<int>(hn::Lanes(d));
  for (int x = 0; x < count; x += step) {
    const auto v = hn::LoadU(hn::Rebind<T, decltype(d)>(), in + x);
    hn::StoreU(hn::ConvertTo(d, hn::PromoteTo(integers, v)), d, out + x);
  }
}

void
ToFloat8(const std::uint8_t *in, int count, float *out)
{
  integers_to_float(in, count, out);
}

void
ToFloat16(const std::uint16_t *in, int count, float *out)
{
  integers_to_float(in, count, out);
}

void
Interpolate(const float *before, const float *after, float weight, int count, float *out)
{
  const Tag<float> d;
  const int step = static_cast<int>(hn::Lanes(d));
  const auto share = hn::Set(d, weight);
  for (int x = 0; x < count; x += step) {
    const auto from = hn::LoadU(d, before + x);
    const auto difference = hn::Sub(hn::LoadU(d, after + x), from);
    hn::StoreU(hn::Add(from, hn::Mul(share, difference)), d, out + x);
  }
}

void
DoubleColumns(float *row, int width, float *out)
{
  const Tag<float> d;
  const int step = static_cast<int>(hn::Lanes(d));
  const auto half = hn::Set(d, 0.5F);
  row[width] = row[width - 1];
  for (int x = 0; x < width; x += step) {
    const auto here = hn::LoadU(d, row + x);
    const auto difference = hn::Sub(hn::LoadU(d, row + x + 1), here);
    const auto between = hn::Add(here, hn::Mul(half, difference));
    hn::StoreInterleaved2(here, between, d, out + 2 * x);
  }
}

void
Interleave(const float *first, const float *second, const float *third, int count, float *out)
{
  const Tag<float> d;
  const int step = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + step <= count; x += step)
    hn::StoreInterleaved3(hn::LoadU(d, first + x), hn::LoadU(d, second + x),
                          hn::LoadU(d, third + x), d, out + static_cast<std::ptrdiff_t>(x) * 3);
  for (; x < count; ++x) {
    float *triple = out + static_cast<std::ptrdiff_t>(x) * 3;
    triple[0] = first[x];
    triple[1] = second[x];
    triple[2] = third[x];
  }
}

} // namespace saliency::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saliency::kernels {

HWY_EXPORT(Unpack8);
HWY_EXPORT(Unpack16);
HWY_EXPORT(HalveColumns8);
HWY_EXPORT(HalveColumns16);
HWY_EXPORT(HalveColumnsFloat);
HWY_EXPORT(HalveRows8);
HWY_EXPORT(HalveRows16);
HWY_EXPORT(HalveRowsFloat);
HWY_EXPORT(ToFloat8);
HWY_EXPORT(ToFloat16);
HWY_EXPORT(Interpolate);
HWY_EXPORT(DoubleColumns);
HWY_EXPORT(Interleave);

void
unpack(const std::uint8_t *in, int stride, int count, std::uint8_t *out)
{
  HWY_DYNAMIC_DISPATCH(Unpack8)(in, stride, count, out);
}

void
unpack(const std::uint8_t *in, int stride, int shift, unsigned mask, int count, std::uint16_t *out)
{
  HWY_DYNAMIC_DISPATCH(Unpack16)(in, stride, shift, mask, count, out);
}

void
halve_columns(std::uint8_t *row, int width, std::uint16_t *halved)
{
  HWY_DYNAMIC_DISPATCH(HalveColumns8)(row, width, halved);
}

void
halve_columns(std::uint16_t *row, int width, std::uint32_t *halved)
{
  HWY_DYNAMIC_DISPATCH(HalveColumns16)(row, width, halved);
}

void
halve_columns(float *row, int width, float *halved)
{
  HWY_DYNAMIC_DISPATCH(HalveColumnsFloat)(row, width, halved);
}

void
halve_rows(const std::array<const std::uint16_t *, 5> &rows, int count, std::uint8_t *halved)
{
  HWY_DYNAMIC_DISPATCH(HalveRows8)(rows, count, halved);
}

void
halve_rows(const std::array<const std::uint32_t *, 5> &rows, int count, std::uint16_t *halved)
{
  HWY_DYNAMIC_DISPATCH(HalveRows16)(rows, count, halved);
}

void
halve_rows(const std::array<const float *, 5> &rows, int count, float *halved)
{
  HWY_DYNAMIC_DISPATCH(HalveRowsFloat)(rows, count, halved);
}

void
to_float(const std::uint8_t *in, int count, float *out)
{
  HWY_DYNAMIC_DISPATCH(ToFloat8)(in, count, out);
}

void
to_float(const std::uint16_t *in, int count, float *out)
{
  HWY_DYNAMIC_DISPATCH(ToFloat16)(in, count, out);
}

void
interpolate(const float *before, const float *after, float weight, int count, float *out)
{
  HWY_DYNAMIC_DISPATCH(Interpolate)(before, after, weight, count, out);
}

void
double_columns(float *row, int width, float *out)
{
  HWY_DYNAMIC_DISPATCH(DoubleColumns)(row, width, out);
}

void
interleave(const float *first, const float *second, const float *third, int count, float *out)
{
  HWY_DYNAMIC_DISPATCH(Interleave)(first, second, third, count, out);
}

} // namespace saliency::kernels
#endif
