// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/temporal_pyramid.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <iterator>
#include <utility>

namespace saliency {

namespace {

constexpr double kShortestEntry = 1.0 / 8;

/// Maps of an age are moved together for this share of it.
constexpr double kShareOfAge = 1.0 / 4;

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
TemporalPyramid::push(const cv::Mat &map, double elapsed, double duration, const Similarity &pose)
{
  if (history_.empty()) {
    const cv::Mat nothing = cv::Mat::zeros(map.size(), CV_64FC1);
    if (start_ == HistoryStart::filled) {
      Entry before{ -longest_, {}, pose };
      add_display(nothing, map, -longest_, before.integral);
      history_.push_back(std::move(before));
    }
    history_.push_back({ 0, nothing, pose });
  } else {
    const double on_show = std::min(elapsed, longest_);
    Entry &last = history_.back();
    const double now = last.time + on_show;
    if (history_.size() > 1 && last.time - std::prev(history_.end(), 2)->time < kShortestEntry) {
      add_display(last.integral, current_, on_show, last.integral);
      last.time = now;
      last.pose = pose;
    } else {
      Entry next{ now, {}, pose };
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
TemporalPyramid::rebase(const Similarity &view)
{
  for (auto &entry : history_)
    entry.pose = view * entry.pose;
}

bool
TemporalPyramid::moved() const
{
  return std::ranges::any_of(
      history_, [this](const Entry &entry) { return entry.pose != history_.back().pose; });
}

void
TemporalPyramid::means(std::span<const int> windows, std::vector<cv::Mat> &maps)
{
  maps.resize(windows.size());
  if (moved())
    moved_means(windows, maps);
  else
    for (std::size_t i = 0; i < windows.size(); ++i)
      mean(windows[i], maps[i]);
}

std::size_t
TemporalPyramid::display_before(double time) const
{
  const auto after = std::lower_bound(history_.begin() + 1, history_.end(), time,
                                      [](const Entry &entry, double t) { return entry.time < t; });
  return static_cast<std::size_t>(std::prev(after) - history_.begin());
}

TemporalPyramid::Moment
TemporalPyramid::moment(double time) const
{
  const auto after = std::upper_bound(history_.begin() + 1, history_.end(), time,
                                      [](double t, const Entry &entry) { return t < entry.time; });
  const Entry &from = *std::prev(after);
  const Entry &to = after == history_.end() ? end_ : *after;
  return { &from, &to, (time - from.time) / (to.time - from.time) };
}

/// With a camera that rests.
void
TemporalPyramid::mean(double window, cv::Mat &map) const
{
  const double start = std::max(end_.time - window, history_.front().time);
  const Moment from = moment(start);
  const double length = end_.time - start;

  map.create(current_.size(), CV_32FC1);
  for (int y = 0; y < map.rows; ++y) {
    const auto *a = from.before->integral.ptr<double>(y);
    const auto *b = from.after->integral.ptr<double>(y);
    const auto *e = end_.integral.ptr<double>(y);
    auto *out = map.ptr<float>(y);
    for (int x = 0; x < map.cols; ++x)
      out[x] = static_cast<float>((e[x] - a[x] - from.part * (b[x] - a[x])) / length);
  }
}

/// From the present back, stretch by stretch. A stretch begins where a display does, as soon as it is
/// as long as a share of its age, or where a window does.
void
TemporalPyramid::moved_means(std::span<const int> windows, std::vector<cv::Mat> &maps)
{
  sum_.create(current_.size(), CV_32FC1);
  sum_.setTo(0);
  double to = end_.time;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const double start = std::max(end_.time - windows[i], history_.front().time);
    while (to > start) {
      const double latest = to - kShareOfAge * (end_.time - to);
      const double from = std::max(start, history_[display_before(latest)].time);
      add_moved(from, to);
      to = from;
    }
    cv::scaleAdd(sum_, 1 / (end_.time - start), current_, maps[i]);
  }
}

/// Adds what was on show from one time to another, less the current map, moved to where it is now.
void
TemporalPyramid::add_moved(double from, double to)
{
  find_stretch(moment(from), to < end_.time ? moment(to) : Moment{ &history_.back(), &end_, 1 });
  const auto length = static_cast<float>(to - from);
  const Similarity &then = history_[display_before((from + to) / 2)].pose;
  if (then == history_.back().pose) {
    sum_ += stretch_;
    cv::scaleAdd(current_, static_cast<double>(-length), sum_, sum_);
    return;
  }

  const Similarity back = then.inverse() * history_.back().pose;
  const auto border = static_cast<float>(kBorder);
  const float right = static_cast<float>(stretch_.cols - 1) - border;
  const float bottom = static_cast<float>(stretch_.rows - 1) - border;
  const auto step_x = static_cast<float>(back.a);
  const auto step_y = static_cast<float>(back.b);
  for (int y = 0; y < sum_.rows; ++y) {
    const auto begin_x = static_cast<float>(back.x(0, y));
    const auto begin_y = static_cast<float>(back.y(0, y));
    const auto *now = current_.ptr<float>(y);
    auto *sum = sum_.ptr<float>(y);
    for (int x = 0; x < sum_.cols; ++x) {
      const float at_x = begin_x + step_x * static_cast<float>(x);
      const float at_y = begin_y + step_y * static_cast<float>(x);
      if (!(at_x >= border && at_y >= border && at_x < right && at_y < bottom))
        continue;
      const int left = static_cast<int>(at_x);
      const int top = static_cast<int>(at_y);
      const float right_share = at_x - static_cast<float>(left);
      const float bottom_share = at_y - static_cast<float>(top);
      const auto *upper = stretch_.ptr<float>(top) + left;
      const auto *lower = stretch_.ptr<float>(top + 1) + left;
      const float above = upper[0] + right_share * (upper[1] - upper[0]);
      const float below = lower[0] + right_share * (lower[1] - lower[0]);
      sum[x] += above + bottom_share * (below - above) - length * now[x];
    }
  }
}

/// `stretch_` becomes the integral from one moment to another.
void
TemporalPyramid::find_stretch(const Moment &from, const Moment &to)
{
  stretch_.create(current_.size(), CV_32FC1);
  for (int y = 0; y < stretch_.rows; ++y) {
    const auto *a = from.before->integral.ptr<double>(y);
    const auto *b = from.after->integral.ptr<double>(y);
    const auto *c = to.before->integral.ptr<double>(y);
    const auto *d = to.after->integral.ptr<double>(y);
    auto *out = stretch_.ptr<float>(y);
    for (int x = 0; x < stretch_.cols; ++x)
      out[x]
          = static_cast<float>(c[x] - a[x] + to.part * (d[x] - c[x]) - from.part * (b[x] - a[x]));
  }
}

std::size_t
TemporalPyramid::size() const
{
  return history_.size();
}

} // namespace saliency
