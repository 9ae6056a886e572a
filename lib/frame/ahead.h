// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/frame_view.h"

#include <cstddef>
#include <cstdint>

namespace saliency {

/// Bytes of a frame that will be needed soon, which who works on others asks memory for meanwhile:
/// as many, a line of the cache from each of kRows rows in turn, as memory delivers more at a time
/// of several rows than of one. They need not be there.
struct Ahead
{
  static constexpr int kRows = 4;

  const std::uint8_t *first;
  std::ptrdiff_t row_stride;
};

/// What to ask for while `part` of `parts` of `at_once` rows from y on is worked on: a part of the
/// group of rows after theirs. What is a row to Ahead is as many of them as fill a page.
///
/// Asking is in vain for a page whose address the processor has yet to look up, and each look-up
/// takes as long as several lines. So where rows are worked on at once, each of which comes to new
/// pages, this from time to time reads a byte of each page that will be asked for later, but those
/// of the first rows: many look-ups at the same time. `at_once` is at most kRows.
Ahead look_ahead(const Component &first, int y, int at_once, int part = 0, int parts = 1);

} // namespace saliency
