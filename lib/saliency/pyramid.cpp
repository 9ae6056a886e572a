// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/pyramid.h"

#include "frame/decimation_kernels.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace saliency {

template <typename Sample>
void
ReductionOf<Sample>::prepare(const cv::Mat &source, cv::Mat &reduced, const Team &team)
{
  CV_Assert(source.type() == cv::DataType<Sample>::type && source.data != reduced.data);
  reduced.create(level_size(source.size(), 1), source.type());
  const auto parts = static_cast<std::size_t>(team.threads());
  if (source.size() != size_ || halved_.size() != parts) {
    halved_.clear();
    while (halved_.size() < parts)
      halved_.emplace_back(source.rows, reduced.cols, 1);
    size_ = source.size();
  }
}

template <typename Sample>
void
ReductionOf<Sample>::make_rows(int part, int begin, int end, const cv::Mat &source,
                               cv::Mat &reduced)
{
  FiveRows<Sample> &halved = halved_[static_cast<std::size_t>(part)];
  halved.begin();
  for (int y = begin; y < end; ++y) {
    halved.advance(y, [&source](int source_y, Sample *row) {
      kernels::halve_columns(source.ptr<Sample>(source_y), source.cols, row);
    });
    kernels::halve_rows(halved.channel(0), reduced.cols, reduced.ptr<Sample>(y));
  }
}

template <typename Sample>
void
ReductionOf<Sample>::operator()(const cv::Mat &source, cv::Mat &reduced, const Team &team)
{
  prepare(source, reduced, team);
  team.share(reduced.rows,
             [&](int part, int begin, int end) { make_rows(part, begin, end, source, reduced); });
}

template class ReductionOf<float>;
template class ReductionOf<Fixed>;

rows::Between
between_rows(const cv::Mat &level, int row, int octaves)
{
  const int before = std::min(row >> octaves, level.rows - 1);
  return { .before = level.ptr<float>(before),
           .after = level.ptr<float>(std::min(before + 1, level.rows - 1)),
           .weight = std::ldexp(static_cast<float>(row & ((1 << octaves) - 1)), -octaves),
           .length = static_cast<std::size_t>(level.cols) };
}

void
upsample(const cv::Mat &source, int octaves_x, int octaves_y, cv::Size size, cv::Mat &upsampled)
{
  CV_Assert(source.type() == CV_32FC1 && source.data != upsampled.data
            && source.cols == level_size(size, octaves_x).width
            && source.rows == level_size(size, octaves_y).height);
  upsampled.create(size, CV_32FC1);
  for (int y = 0; y < size.height; ++y)
    rows::enlarge(between_rows(source, y, octaves_y), octaves_x,
                  static_cast<std::size_t>(size.width), upsampled.ptr<float>(y));
}

void
Pyramid::resize(int base, int coarsest)
{
  base_ = base;
  levels_.resize(static_cast<std::size_t>(coarsest - base) + 1);
  reductions_.resize(levels_.size());
  fixed_.resize(levels_.size());
  fixed_reductions_.resize(levels_.size());
}

void
Pyramid::build(const LabImage &image, int base, int coarsest)
{
  resize(base, coarsest);
  levels_[0] = image;
  borrowed_ = true;
  for (std::size_t i = 1; i < levels_.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      reductions_[i](levels_[i - 1].planes[c], levels_[i].planes[c]);
}

void
Pyramid::build(const FixedLabImage &image, int base, int coarsest, int chroma, const Team &team)
{
  resize(base, coarsest);
  fixed_[0] = image;
  if (std::exchange(borrowed_, false))
    levels_[0] = {};
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      if (i > 0)
        fixed_reductions_[i][c].prepare(fixed_[i - 1].planes[c], fixed_[i].planes[c], team);
      if (c == 0 || base + static_cast<int>(i) >= chroma)
        levels_[i].planes[c].create(fixed_[i].size(), CV_32FC1);
      else
        levels_[i].planes[c].release();
    }
    team.share(fixed_[i].size().height, [this, i](int part, int begin, int end) {
      for (std::size_t c = 0; c < 3; ++c) {
        cv::Mat &fixed = fixed_[i].planes[c];
        if (i > 0)
          fixed_reductions_[i][c].make_rows(part, begin, end, fixed_[i - 1].planes[c], fixed);
        if (cv::Mat &plane = levels_[i].planes[c]; !plane.empty())
          to_float(fixed, begin, end, plane);
      }
    });
  }
}

const LabImage &
Pyramid::level(int n) const
{
  return levels_.at(static_cast<std::size_t>(n - base_));
}

} // namespace saliency
