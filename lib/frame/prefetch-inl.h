// SPDX-License-Identifier: LGPL-2.1-or-later
// Prefetch instructions for kernels, in sources that Highway compiles once per target.
#if defined(SALIENCY_PREFETCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SALIENCY_PREFETCH_INL_H
#undef SALIENCY_PREFETCH_INL_H
#else
#define SALIENCY_PREFETCH_INL_H
#endif

#include "frame/prefetch.h"

#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace saliency::HWY_NAMESPACE {

/// Prefetches the share of `ahead` that belongs to one step of a kernel: `bytes` are read per step
/// and `done` have been read so far. Loads go to the L1 cache; they are evicted to L2 before use,
/// but they also start the CPU's own hardware prefetcher.
template <std::size_t bytes>
HWY_INLINE void
prefetch(const Prefetch &ahead, std::ptrdiff_t done)
{
  constexpr std::size_t kLine = 64;
  constexpr std::size_t kLines = std::max<std::size_t>(1, bytes / kLine);
  constexpr std::size_t kTurn = Prefetch::kRows / kLines; // steps for a cache line of each row
  static_assert(kTurn * kLines == Prefetch::kRows);
  const std::size_t step = static_cast<std::size_t>(done) / std::max(bytes, kLine);
  const auto row = static_cast<std::ptrdiff_t>(step % kTurn * kLines);
  for (std::size_t i = 0; i < kLines; ++i)
    __builtin_prefetch(ahead.first + (row + static_cast<std::ptrdiff_t>(i)) * ahead.row_stride
                           + step / kTurn * kLine,
                       0, 3);
}

} // namespace saliency::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
