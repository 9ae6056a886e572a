// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/pyramid.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
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

/// Where a sample of a finer level lies among the samples of a coarser one.
struct GridPosition
{
  int before;
  int after;
  float weight; ///< of `after`
};

GridPosition
locate(int index, int octaves, int length)
{
  const int before = std::min(index >> octaves, length - 1);
  const int after = std::min(before + 1, length - 1);
  const int step = 1 << octaves;
  return { before, after, static_cast<float>(index & (step - 1)) / static_cast<float>(step) };
}

inline float
interpolate(float before, float after, float weight)
{
  return before + weight * (after - before);
}

template <int channels>
void
upsample_row(const float *source, const std::vector<GridPosition> &columns, float *out)
{
  for (const auto &at : columns) {
    const float *before = source + static_cast<std::ptrdiff_t>(at.before) * channels;
    const float *after = source + static_cast<std::ptrdiff_t>(at.after) * channels;
    for (int c = 0; c < channels; ++c)
      *out++ = interpolate(before[c], after[c], at.weight);
  }
}

} // namespace

cv::Size
level_size(cv::Size size, int level)
{
  return { halved(size.width, level), halved(size.height, level) };
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
  cv::pyrDown(source, reduced, level_size(source.size(), 1));
}

void
reduce_columns(const cv::Mat &source, cv::Mat &reduced)
{
  reduced.create(source.rows, halved(source.cols, 1), CV_32FC1);
  for (int x = 0; x < reduced.cols; ++x) {
    const int x0 = mirrored(2 * x - 2, source.cols);
    const int x1 = mirrored(2 * x - 1, source.cols);
    const int x2 = 2 * x;
    const int x3 = mirrored(2 * x + 1, source.cols);
    const int x4 = mirrored(2 * x + 2, source.cols);
    for (int y = 0; y < source.rows; ++y) {
      const auto *in = source.ptr<float>(y);
      reduced.at<float>(y, x) = (in[x0] + in[x4] + 4 * (in[x1] + in[x3]) + 6 * in[x2]) / 16;
    }
  }
}

void
reduce_rows(const cv::Mat &source, cv::Mat &reduced)
{
  reduced.create(halved(source.rows, 1), source.cols, CV_32FC1);
  for (int y = 0; y < reduced.rows; ++y) {
    const auto *in0 = source.ptr<float>(mirrored(2 * y - 2, source.rows));
    const auto *in1 = source.ptr<float>(mirrored(2 * y - 1, source.rows));
    const auto *in2 = source.ptr<float>(2 * y);
    const auto *in3 = source.ptr<float>(mirrored(2 * y + 1, source.rows));
    const auto *in4 = source.ptr<float>(mirrored(2 * y + 2, source.rows));
    auto *out = reduced.ptr<float>(y);
    for (int x = 0; x < source.cols; ++x)
      out[x] = (in0[x] + in4[x] + 4 * (in1[x] + in3[x]) + 6 * in2[x]) / 16;
  }
}

void
upsample(const cv::Mat &source, int octaves_x, int octaves_y, cv::Size size, cv::Mat &upsampled)
{
  const int channels = source.channels();
  CV_Assert(source.depth() == CV_32F && (channels == 1 || channels == 3)
            && source.data != upsampled.data);
  upsampled.create(size, source.type());

  std::vector<GridPosition> columns;
  columns.reserve(static_cast<std::size_t>(size.width));
  for (int x = 0; x < size.width; ++x)
    columns.push_back(locate(x, octaves_x, source.cols));

  std::vector<float> between(static_cast<std::size_t>(source.cols)
                             * static_cast<std::size_t>(channels));
  for (int y = 0; y < size.height; ++y) {
    const auto at = locate(y, octaves_y, source.rows);
    const auto *before = source.ptr<float>(at.before);
    const auto *after = source.ptr<float>(at.after);
    for (std::size_t i = 0; i < between.size(); ++i)
      between[i] = interpolate(before[i], after[i], at.weight);
    auto *out = upsampled.ptr<float>(y);
    if (channels == 1)
      upsample_row<1>(between.data(), columns, out);
    else
      upsample_row<3>(between.data(), columns, out);
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
