// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/pyramid.h"

#include "saliency/rows.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace saliency {

namespace {

int
halved(int length, int octaves)
{
  return octaves < 31
             ? static_cast<int>((static_cast<long long>(length) + (1LL << octaves) - 1) >> octaves)
             : 1;
}

int
mirrored(int index, int length)
{
  return cv::borderInterpolate(index, length, cv::BORDER_REFLECT_101);
}

/// Of so many columns at a time the reduced image is made: what is between fits on the stack.
constexpr int kBlock = 256;

/// The columns [begin, end) of one row of the reduced image, from the five rows about it.
template <std::size_t channels>
void
reduce_block(const std::array<const float *, 5> &rows, int length, int begin, int end, float *out)
{
  // The source's columns there are, and the two on either side, mirrored where there are none.
  const int first = 2 * begin - 2;
  const int last = 2 * end;
  const int from = std::max(first, 0);
  const int until = std::min(last + 1, length);
  const auto count = static_cast<std::size_t>(until - from);
  std::array<std::array<float, 2 * kBlock + 4>, channels> planes;
  std::array<float *, channels> inside;
  for (std::size_t c = 0; c < channels; ++c)
    inside[c] = planes[c].data() + (from - first);

  auto in = rows;
  for (const float *&row : in)
    row += static_cast<std::size_t>(from) * channels;
  const auto halved_count = static_cast<std::size_t>(end - begin);
  const auto halve = [&](std::size_t c, float *to) {
    for (int x = first; x < from; ++x)
      planes[c][static_cast<std::size_t>(x - first)] = inside[c][mirrored(x, length) - from];
    for (int x = until; x <= last; ++x)
      inside[c][x - from] = inside[c][mirrored(x, length) - from];
    rows::halve(planes[c].data() + 2, halved_count, to);
  };
  if constexpr (channels == 1) {
    rows::smooth(in, count, inside[0]);
    halve(0, out + begin);
  } else {
    std::array<float, (2 * kBlock + 4) * channels> smoothed;
    rows::smooth(in, count * channels, smoothed.data());
    rows::split(smoothed.data(), count, inside);
    std::array<std::array<float, kBlock>, channels> halves;
    for (std::size_t c = 0; c < channels; ++c)
      halve(c, halves[c].data());
    rows::join({ halves[0].data(), halves[1].data(), halves[2].data() }, halved_count,
               out + static_cast<std::size_t>(begin) * channels);
  }
}

} // namespace

cv::Size
level_size(cv::Size size, int level)
{
  return { halved(size.width, level), halved(size.height, level) };
}

RowPosition
locate_row(int row, int octaves, int rows)
{
  const int before = std::min(row >> octaves, rows - 1);
  return { before, std::min(before + 1, rows - 1),
           std::ldexp(static_cast<float>(row & ((1 << octaves) - 1)), -octaves) };
}

int
coarsest_level(cv::Size size)
{
  int level = 0;
  while (level_size(size, level) != cv::Size(1, 1))
    ++level;
  return level;
}

void
reduce(const cv::Mat &source, cv::Mat &reduced)
{
  const int channels = source.channels();
  if (source.depth() != CV_32F || (channels != 1 && channels != 3)) {
    cv::pyrDown(source, reduced, level_size(source.size(), 1));
    return;
  }
  reduced.create(level_size(source.size(), 1), source.type());
  for (int y = 0; y < reduced.rows; ++y) {
    std::array<const float *, 5> rows;
    for (int i = 0; i < 5; ++i)
      rows[static_cast<std::size_t>(i)] = source.ptr<float>(mirrored(2 * y - 2 + i, source.rows));
    for (int x = 0; x < reduced.cols; x += kBlock) {
      const int end = std::min(x + kBlock, reduced.cols);
      if (channels == 1)
        reduce_block<1>(rows, source.cols, x, end, reduced.ptr<float>(y));
      else
        reduce_block<3>(rows, source.cols, x, end, reduced.ptr<float>(y));
    }
  }
}

void
upsample(const cv::Mat &source, int octaves_x, int octaves_y, cv::Size size, cv::Mat &upsampled)
{
  CV_Assert(source.type() == CV_32FC1 && source.data != upsampled.data
            && source.cols == halved(size.width, octaves_x)
            && source.rows == halved(size.height, octaves_y));
  upsampled.create(size, CV_32FC1);
  const auto length = static_cast<std::size_t>(source.cols);
  const auto width = static_cast<std::size_t>(size.width);
  for (int i = 0; i < source.rows; ++i)
    rows::enlarge(source.ptr<float>(i), length, octaves_x, width,
                  upsampled.ptr<float>(i << octaves_y));
  for (int y = 0; y < size.height; ++y) {
    const RowPosition at = locate_row(y, octaves_y, source.rows);
    if (y != at.before << octaves_y)
      rows::interpolate(upsampled.ptr<float>(at.before << octaves_y),
                        upsampled.ptr<float>(at.after << octaves_y), at.weight, width,
                        upsampled.ptr<float>(y));
  }
}

void
Pyramid::build(const cv::Mat &image, int base, int coarsest)
{
  base_ = base;
  levels_.resize(static_cast<std::size_t>(coarsest - base) + 1);
  levels_[0] = image;
  for (std::size_t i = 1; i < levels_.size(); ++i)
    reduce(levels_[i - 1], levels_[i]);
}

const cv::Mat &
Pyramid::level(int n) const
{
  return levels_.at(static_cast<std::size_t>(n - base_));
}

} // namespace saliency
