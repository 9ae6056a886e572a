// SPDX-License-Identifier: LGPL-2.1-or-later
// How rows are gone through by whole vectors, for sources that Highway compiles once for each
// target: so this is included once for each, too.
#if defined(SALIENCY_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SALIENCY_VECTORS_INL_H
#undef SALIENCY_VECTORS_INL_H
#else
#define SALIENCY_VECTORS_INL_H
#endif

#include <hwy/highway.h>

#include <cstdint>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace saliency::HWY_NAMESPACE {

/// Vectors of up to 64 bytes.
template <typename T> using Vectors = hwy::HWY_NAMESPACE::CappedTag<T, 64 / sizeof(T)>;
template <typename T> using OneLane = hwy::HWY_NAMESPACE::CappedTag<T, 1>;

/// Calls work(d, x) so that vectors at x cover 0…count - 1, once each: what is left of them one by
/// one.
template <typename T, typename Index, typename Work>
HWY_INLINE void
each_once(Index count, const Work &work)
{
  const Vectors<T> d;
  const auto step = static_cast<Index>(hwy::HWY_NAMESPACE::Lanes(d));
  Index x = 0;
  for (; x + step <= count; x += step)
    work(d, x);
  for (; x < count; ++x)
    work(OneLane<T>(), x);
}

/// The same, quicker, where it does no harm to do some a second time (so not in place): the last
/// vector goes over some that the one before it has done. Fewer than a vector's are done one by
/// one.
template <typename T, typename Index, typename Work>
HWY_INLINE void
cover(Index count, const Work &work)
{
  const Vectors<T> d;
  const auto step = static_cast<Index>(hwy::HWY_NAMESPACE::Lanes(d));
  if (count < step) {
    each_once<T>(count, work);
    return;
  }
  Index x = 0;
  for (; x + step <= count; x += step)
    work(d, x);
  if (x < count)
    work(d, count - step);
}

/// Lanes from memory that need not be aligned for them: as many samples of less width as fit.
template <class D>
HWY_INLINE hwy::HWY_NAMESPACE::VFromD<D>
load_bytes(D d, const void *bytes)
{
  hwy::HWY_NAMESPACE::TFromD<D> lane;
  if constexpr (hwy::HWY_NAMESPACE::MaxLanes(D()) == 1) {
    std::memcpy(&lane, bytes, sizeof lane);
    return hwy::HWY_NAMESPACE::Set(d, lane);
  } else {
    const hwy::HWY_NAMESPACE::Repartition<std::uint8_t, D> d8;
    return hwy::HWY_NAMESPACE::BitCast(
        d, hwy::HWY_NAMESPACE::LoadU(d8, static_cast<const std::uint8_t *>(bytes)));
  }
}

} // namespace saliency::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
