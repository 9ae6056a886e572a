// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/frame_view.h"

#include <cstddef>
#include <cstdint>

namespace saliency {

/// Bytes of a frame that will be needed soon, which who works on others asks memory for meanwhile: as many,
/// a line of the cache from each of kRows rows in turn, as memory delivers more at a time of many rows than
/// of one. They need not be there.
struct Ahead
{
  static constexpr int kRows = 8;

  const std::uint8_t *first;
  std::ptrdiff_t row_stride;
};

/// What to ask for while `part` of `parts` of `at_once` rows from y on is worked on: a part of the group of
/// rows after theirs. What is a row to Ahead is as many of them as fill a page.
Ahead ahead_of(const Component &first, int y, int at_once, int part = 0, int parts = 1);

} // namespace saliency
