// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame/block_means.h"

#include "frame/component_rows.h"
#include "frame/levels.h"
#include "frame/row_sums.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace saliency {

namespace {

/// Rows of a block that are read, so that the look at large frames stays cheap.
constexpr int kMostRows = 8;

} // namespace

const std::array<cv::Mat1f, 3> &
BlockMeans::operator()(const FrameView &frame, int level)
{
  for (std::size_t i = 0; i < means_.size(); ++i)
    if (frame.model == ColorModel::gray && i > 0)
      means_[i].release();
    else
      add(frame, frame.components[i], level, means_[i]);
  return means_;
}

void
BlockMeans::add(const FrameView &frame, const Component &component, int level, cv::Mat1f &means)
{
  means.create(level_size({ frame.width, frame.height }, level));
  const int columns = 1 << std::max(0, level - subsampling(frame.width, component.width));
  const int rows = 1 << std::max(0, level - subsampling(frame.height, component.height));
  const bool bytes = frame.depth == 8;
  const auto step = static_cast<std::size_t>(component.pixel_stride) / (bytes ? 1 : 2);
  const std::size_t count = static_cast<std::size_t>(component.width - 1) * step + 1;
  sums_.resize(std::max(sums_.size(), count));
  for (int y = 0; y < means.rows; ++y) {
    // Chroma coarser than the blocks is repeated.
    const int first = std::min(y * rows, component.height - 1);
    const int step_down = std::max(1, rows / kMostRows) | 1; // odd: of both fields
    const int height = (std::min(rows, component.height - first) + step_down - 1) / step_down;
    const std::ptrdiff_t stride = component.row_stride * step_down;
    const std::uint8_t *data = component.data + first * component.row_stride;
    if (bytes)
      kernels::sum_rows(data, stride, height, count, sums_.data());
    else
      kernels::sum_rows(data, stride, height, frame.depth + frame.shift - 8, count, sums_.data());
    for (int x = 0; x < means.cols; ++x) {
      const int left = std::min(x * columns, component.width - 1);
      const int width = std::min(columns, component.width - left);
      const std::uint16_t *sum = sums_.data() + static_cast<std::size_t>(left) * step;
      unsigned total = 0;
      for (int i = 0; i < width; ++i, sum += step)
        total += *sum;
      means(y, x) = static_cast<float>(total) / static_cast<float>(width * height);
    }
  }
}

} // namespace saliency
