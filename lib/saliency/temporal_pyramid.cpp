// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/temporal_pyramid.h"

#include "saliency/rows.h"

#include <algorithm>

namespace saliency {

TemporalPyramid::TemporalPyramid(int longest) : sums_(static_cast<std::size_t>(longest) + 1)
{
}

void
TemporalPyramid::reset()
{
  count_ = 0;
}

void
TemporalPyramid::push(const cv::Mat &map)
{
  if (count_ == 0) {
    sums_[0].create(map.size(), CV_64FC1);
    std::fill_n(sums_[0].ptr<double>(), map.total(), 0.0); // cv::Mat::setTo allocates
  }
  const cv::Mat &before = sum(count_++);
  cv::Mat &now = sums_[count_ % sums_.size()];
  now.create(map.size(), CV_64FC1);
  rows::integrate(before.ptr<double>(), map.ptr<float>(), map.total(), now.ptr<double>());
}

void
TemporalPyramid::means(std::span<const int> windows, std::vector<cv::Mat> &maps,
                       const Team &team) const
{
  maps.resize(windows.size());
  team.each(static_cast<int>(windows.size()), [&](int window) {
    const auto i = static_cast<std::size_t>(window);
    const std::size_t length = std::min(static_cast<std::size_t>(windows[i]), count_);
    const cv::Mat &from = sum(count_ - length);
    maps[i].create(from.size(), CV_32FC1);
    rows::difference(from.ptr<double>(), sum(count_).ptr<double>(), 1 / static_cast<double>(length),
                     from.total(), maps[i].ptr<float>());
  });
}

} // namespace saliency
