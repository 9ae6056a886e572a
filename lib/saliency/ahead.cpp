// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/ahead.h"

#include <algorithm>
#include <cstdlib>

namespace saliency {

Ahead
ahead_of(const Component &first, int y, int at_once, int part, int parts)
{
  constexpr std::ptrdiff_t kPage = 4096;
  constexpr std::ptrdiff_t kStreams = Ahead::kRows;
  const std::ptrdiff_t stride = std::max<std::ptrdiff_t>(1, std::abs(first.row_stride));
  const std::ptrdiff_t rows = (kPage - 1) / stride + 1;
  const std::ptrdiff_t group = kStreams * rows;
  const std::ptrdiff_t place = y % group / at_once * parts + part;
  return { first.data + (y / group + 1) * group * first.row_stride
               + place * stride * at_once / (kStreams * parts),
           first.row_stride * rows };
}

} // namespace saliency
