// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/temporal_pyramid.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <iterator>
#include <utility>

namespace saliency {

namespace {

constexpr double kShortestEntry = 1.0 / 8;

/// sum = base + map × duration; base and sum may be the same.
void
add_display(const cv::Mat &base, const cv::Mat &map, double duration, cv::Mat &sum)
{
  sum.create(map.size(), CV_64FC1);
  for (int y = 0; y < map.rows; ++y) {
    const auto *b = base.ptr<double>(y);
    const auto *m = map.ptr<float>(y);
    auto *out = sum.ptr<double>(y);
    for (int x = 0; x < map.cols; ++x)
      out[x] = b[x] + duration * static_cast<double>(m[x]);
  }
}

} // namespace

TemporalPyramid::TemporalPyramid(double longest, HistoryStart start)
    : longest_(longest), start_(start)
{
}

void
TemporalPyramid::reset()
{
  history_.clear();
}

void
TemporalPyramid::push(const cv::Mat &map, double elapsed, double duration)
{
  if (history_.empty()) {
    const cv::Mat nothing = cv::Mat::zeros(map.size(), CV_64FC1);
    if (start_ == HistoryStart::filled) {
      Entry before{ -longest_, {} };
      add_display(nothing, map, -longest_, before.integral);
      history_.push_back(std::move(before));
    }
    history_.push_back({ 0, nothing });
  } else {
    const double on_show = std::min(elapsed, longest_);
    Entry &last = history_.back();
    const double now = last.time + on_show;
    if (history_.size() > 1 && last.time - std::prev(history_.end(), 2)->time < kShortestEntry) {
      add_display(last.integral, current_, on_show, last.integral);
      last.time = now;
    } else {
      Entry next{ now, {} };
      add_display(last.integral, current_, on_show, next.integral);
      history_.push_back(std::move(next));
    }
    while (history_[1].time <= now - longest_)
      history_.pop_front();
  }

  map.copyTo(current_);
  const double displayed = std::min(duration, kLongestDisplay);
  end_.time = history_.back().time + displayed;
  add_display(history_.back().integral, current_, displayed, end_.integral);
}

void
TemporalPyramid::mean(double window, cv::Mat &map) const
{
  const double start = std::max(end_.time - window, history_.front().time);
  const auto after
      = std::upper_bound(history_.begin(), history_.end(), start,
                         [](double time, const Entry &entry) { return time < entry.time; });
  const Entry &from = *std::prev(after);
  const Entry &to = after == history_.end() ? end_ : *after;
  const double part = (start - from.time) / (to.time - from.time);
  const double length = end_.time - start;

  map.create(current_.size(), CV_32FC1);
  for (int y = 0; y < map.rows; ++y) {
    const auto *a = from.integral.ptr<double>(y);
    const auto *b = to.integral.ptr<double>(y);
    const auto *e = end_.integral.ptr<double>(y);
    auto *out = map.ptr<float>(y);
    for (int x = 0; x < map.cols; ++x)
      out[x] = static_cast<float>((e[x] - a[x] - part * (b[x] - a[x])) / length);
  }
}

std::size_t
TemporalPyramid::size() const
{
  return history_.size();
}

} // namespace saliency
