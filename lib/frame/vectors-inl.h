// SPDX-License-Identifier: LGPL-2.1-or-later
// Iteration over rows by whole vectors, in sources that Highway compiles once per target. Included
// once per target, too.
#if defined(SALIENCY_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SALIENCY_VECTORS_INL_H
#undef SALIENCY_VECTORS_INL_H
#else
#define SALIENCY_VECTORS_INL_H
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace saliency::HWY_NAMESPACE {

/// Vectors of up to 64 bytes.
template <typename T> using Vectors = hwy::HWY_NAMESPACE::CappedTag<T, 64 / sizeof(T)>;
template <typename T> using OneLane = hwy::HWY_NAMESPACE::CappedTag<T, 1>;

/// Calls work(d, x) so that vectors at x cover 0…count - 1 exactly once; the remainder is done one
/// by one.
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

/// The same, faster, where work may be repeated (so not in place): the last vector overlaps the one
/// before it. Less than one vector is done one by one.
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

/// Loads a vector from unaligned memory, which may hold narrower samples.
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

/// Stores the lanes that count, in order, and returns their number. A whole vector may be
/// overwritten, which is faster than a masked store: in a row that is compressed, those lanes have
/// been read.
template <class D>
HWY_INLINE std::size_t
compress(D d, hwy::HWY_NAMESPACE::Vec<D> values, hwy::HWY_NAMESPACE::Mask<D> counts, float *out)
{
  if constexpr (hwy::HWY_NAMESPACE::MaxLanes(D()) == 1)
    return hwy::HWY_NAMESPACE::CompressBlendedStore(values, counts, d, out);
  else
    return hwy::HWY_NAMESPACE::CompressStore(values, counts, d, out);
}

} // namespace saliency::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
