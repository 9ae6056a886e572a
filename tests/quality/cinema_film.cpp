// SPDX-License-Identifier: LGPL-2.1-or-later
#include "cinema_film.h"

namespace quality {

cv::Rect2d
clipped(const cv::Rect2d &rect, cv::Size frame)
{
  return rect & cv::Rect2d(0, 0, frame.width, frame.height);
}

std::bitset<9>
cells_of(const cv::Rect2d &rect, cv::Size frame)
{
  constexpr double kShare = 0.1;
  const cv::Rect2d visible = clipped(rect, frame);
  const double width = frame.width / 3.0;
  const double height = frame.height / 3.0;
  std::bitset<9> cells;
  for (int i = 0; i < 9; ++i) {
    const cv::Rect2d cell(i % 3 * width, i / 3 * height, width, height); // NOLINT: whole rows
    const double area = (visible & cell).area();
    cells[static_cast<std::size_t>(i)] = area > 0 && area >= kShare * visible.area();
  }
  return cells;
}

Expected
anything()
{
  Expected expected;
  expected.verdict = Verdict::allowed;
  expected.cells.set();
  return expected;
}

} // namespace quality
