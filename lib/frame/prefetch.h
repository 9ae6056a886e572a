// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/frame_view.h"

#include <cstddef>
#include <cstdint>

namespace saliency {

/// Bytes of a frame to prefetch while other rows are processed. One cache line of each of kRows
/// rows is fetched in turn: memory is faster when several rows are read at once. The addresses may
/// lie outside the frame, since a prefetch never faults.
struct Prefetch
{
  static constexpr int kRows = 4;

  const std::uint8_t *first;
  std::ptrdiff_t row_stride;
};

/// The part to prefetch while `part` of `parts` of the `at_once` rows from `y` on is processed: a
/// share of the next group of rows. Where several rows fit in a page, that many count as one row.
///
/// A prefetch that misses the TLB is dropped, and a page walk takes as long as several cache
/// misses. Rows that are processed at once need a page each. For these, the function now and then
/// reads one byte of each page of later rows, so that many page walks overlap. The first rows of a
/// frame are left out. `at_once` is at most kRows.
Prefetch plan_prefetch(const Component &first, int y, int at_once, int part = 0, int parts = 1);

} // namespace saliency
