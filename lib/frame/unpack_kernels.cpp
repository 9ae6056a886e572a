// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame/unpack_kernels.h"

#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "frame/unpack_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "frame/prefetch-inl.h"
#include "frame/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace saliency::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using saliency::HWY_NAMESPACE::cover;
using saliency::HWY_NAMESPACE::load_bytes;
using saliency::HWY_NAMESPACE::prefetch;
template <typename T> using Tag = saliency::HWY_NAMESPACE::Vectors<T>;

void
Unpack8(const std::uint8_t *in, int stride, int count, std::uint8_t *out)
{
  std::ptrdiff_t x = 0;
#if HWY_TARGET != HWY_SCALAR
  // A vector also covers the bytes between samples, so vectors stop before the last sample.
  const Tag<std::uint8_t> d;
  const hn::Repartition<std::uint16_t, decltype(d)> d16;
  const auto step = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  if (stride == 2) {
    for (; x + step < count; x += step) {
      const auto *at = in + x * 2;
      hn::StoreU(hn::ConcatEven(d, hn::LoadU(d, at + step), hn::LoadU(d, at)), d, out + x);
    }
  } else if (stride == 4) {
    for (; x + step < count; x += step) {
      const auto *at = in + x * 4;
      const auto low = hn::ConcatEven(d16, load_bytes(d16, at + step), load_bytes(d16, at));
      const auto high
          = hn::ConcatEven(d16, load_bytes(d16, at + 3 * step), load_bytes(d16, at + 2 * step));
      hn::StoreU(hn::ConcatEven(d, hn::BitCast(d, high), hn::BitCast(d, low)), d, out + x);
    }
  }
#endif
  for (; x < count; ++x)
    out[x] = in[x * stride];
}

void
Unpack16(const std::uint8_t *in, int stride, int left, unsigned mask, int count, Fixed *out,
         [[maybe_unused]] const Prefetch &ahead)
{
  std::ptrdiff_t x = 0;
#if HWY_TARGET != HWY_SCALAR
  const Tag<std::uint16_t> d;
  const auto step = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  const auto bits = hn::Set(d, static_cast<std::uint16_t>(mask));
  if (stride == 2) {
    for (; x + step <= count; x += step) {
      prefetch<2 * hn::MaxLanes(d)>(ahead, x * 2);
      const auto words = load_bytes(d, in + x * 2);
      hn::StoreU(hn::ShiftRight<1>(hn::And(hn::ShiftLeftSame(words, left), bits)), d, out + x);
    }
  } else if (stride == 4) {
    for (; x + step < count; x += step) {
      const auto *at = in + x * 4;
      prefetch<4 * hn::MaxLanes(d)>(ahead, x * 4);
      const auto words = hn::ConcatEven(d, load_bytes(d, at + 2 * step), load_bytes(d, at));
      hn::StoreU(hn::ShiftRight<1>(hn::And(hn::ShiftLeftSame(words, left), bits)), d, out + x);
    }
  }
#endif
  for (; x < count; ++x) {
    const auto *word = in + x * stride;
    out[x]
        = static_cast<Fixed>((static_cast<unsigned>(word[0] | word[1] << 8) << left & mask) >> 1);
  }
}

void
UnpackTriples(const std::uint8_t *in, int stride, int count,
              const std::array<std::uint8_t *, 3> &out)
{
  std::ptrdiff_t x = 0;
#if HWY_TARGET != HWY_SCALAR
  const Tag<std::uint8_t> d;
  const hn::Repartition<std::uint16_t, decltype(d)> d16;
  const auto step = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  if (stride == 3) {
    for (; x + step <= count; x += step) {
      hn::Vec<decltype(d)> first, second, third;
      hn::LoadInterleaved3(d, in + x * 3, first, second, third);
      hn::StoreU(first, d, out[0] + x);
      hn::StoreU(second, d, out[1] + x);
      hn::StoreU(third, d, out[2] + x);
    }
  } else if (stride == 4) {
    for (; x + step < count; x += step) {
      const auto *at = in + x * 4;
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
      out[c][x] = in[x * stride + static_cast<std::ptrdiff_t>(c)];
}

void
Widen(const std::uint8_t *in, int count, Fixed *out)
{
  cover<Fixed>(count, [&](auto d, int x) HWY_ATTR {
    const auto bytes = hn::LoadU(hn::Rebind<std::uint8_t, decltype(d)>(), in + x);
    hn::StoreU(hn::ShiftLeft<7>(hn::PromoteTo(d, bytes)), d, out + x);
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
HWY_EXPORT(ToFloat);

void
unpack(const std::uint8_t *in, int stride, int count, std::uint8_t *out)
{
  HWY_DYNAMIC_DISPATCH(Unpack8)(in, stride, count, out);
}

void
unpack(const std::uint8_t *in, int stride, int left, unsigned mask, int count, Fixed *out,
       const Prefetch &ahead)
{
  HWY_DYNAMIC_DISPATCH(Unpack16)(in, stride, left, mask, count, out, ahead);
}

void
unpack_triples(const std::uint8_t *in, int stride, int count,
               const std::array<std::uint8_t *, 3> &out)
{
  HWY_DYNAMIC_DISPATCH(UnpackTriples)(in, stride, count, out);
}

void
widen(const std::uint8_t *in, int count, Fixed *out)
{
  HWY_DYNAMIC_DISPATCH(Widen)(in, count, out);
}

void
to_float(const Fixed *in, int count, float scale, float offset, float *out)
{
  HWY_DYNAMIC_DISPATCH(ToFloat)(in, count, scale, offset, out);
}

} // namespace saliency::kernels
#endif
