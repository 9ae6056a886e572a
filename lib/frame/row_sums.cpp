// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame/row_sums.h"

// Everything up to HWY_ONCE is compiled once per target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "frame/row_sums.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "frame/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace saliency::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using saliency::HWY_NAMESPACE::cover;
using saliency::HWY_NAMESPACE::load_bytes;
using saliency::HWY_NAMESPACE::Vectors;

void
SumBytes(const std::uint8_t *first, std::ptrdiff_t stride, int rows, std::size_t count,
         std::uint16_t *sums)
{
  // Two bytes a lane: their sums are made apart, and interleaved at the end.
  const Vectors<std::uint16_t> d;
  const std::size_t step = 2 * hn::Lanes(d);
  const auto columns = [=](std::size_t x) HWY_ATTR {
    auto even = hn::Zero(d);
    auto odd = hn::Zero(d);
    for (int y = 0; y < rows; ++y) {
      const auto pairs = load_bytes(d, first + y * stride + x);
      even = hn::Add(even, hn::And(pairs, hn::Set(d, 0xFF)));
      odd = hn::Add(odd, hn::ShiftRight<8>(pairs));
    }
    hn::StoreInterleaved2(even, odd, d, sums + x);
  };
  std::size_t x = 0;
  for (; x + step <= count; x += step)
    columns(x);
  if (x < count && count >= step) {
    columns(count - step);
    return;
  }
  for (; x < count; ++x) {
    unsigned sum = 0;
    for (int y = 0; y < rows; ++y)
      sum += first[y * stride + static_cast<std::ptrdiff_t>(x)];
    sums[x] = static_cast<std::uint16_t>(sum);
  }
}

void
SumWords(const std::uint8_t *first, std::ptrdiff_t stride, int rows, int shift, std::size_t count,
         std::uint16_t *sums)
{
  cover<std::uint16_t>(count, [=](auto d, std::size_t x) HWY_ATTR {
    auto sum = hn::Zero(d);
    for (int y = 0; y < rows; ++y)
      sum = hn::Add(sum,
                    hn::And(hn::ShiftRightSame(load_bytes(d, first + y * stride + 2 * x), shift),
                            hn::Set(d, 0xFF)));
    hn::StoreU(sum, d, sums + x);
  });
}

} // namespace saliency::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace saliency::kernels {

HWY_EXPORT(SumBytes);
HWY_EXPORT(SumWords);

void
sum_rows(const std::uint8_t *first, std::ptrdiff_t stride, int rows, std::size_t count,
         std::uint16_t *sums)
{
  HWY_DYNAMIC_DISPATCH(SumBytes)(first, stride, rows, count, sums);
}

void
sum_rows(const std::uint8_t *first, std::ptrdiff_t stride, int rows, int shift, std::size_t count,
         std::uint16_t *sums)
{
  HWY_DYNAMIC_DISPATCH(SumWords)(first, stride, rows, shift, count, sums);
}

} // namespace saliency::kernels
#endif
