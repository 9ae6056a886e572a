// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/temporal_pyramid.h"

#include "saliency/rows.h"
#include "saliency/sampling.h"

#include <opencv2/core.hpp>

#include <algorithm>

namespace saliency {

namespace {

constexpr double kShortestEntry = 1.0 / 8;

/// Maps are warped together if they span at most this share of their age.
constexpr double kShareOfAge = 1.0 / 4;

/// cv::Mat::setTo allocates.
void
clear(cv::Mat &integral)
{
  std::fill_n(integral.ptr<double>(), integral.total(), 0.0);
}

} // namespace

TemporalPyramid::TemporalPyramid(double longest, HistoryStart start)
    : longest_(longest), start_(start)
{
}

void
TemporalPyramid::reset()
{
  oldest_ = 0;
  count_ = 0;
}

/// Appends an entry whose integral is not yet computed.
TemporalPyramid::Entry &
TemporalPyramid::add_entry(double time, const Similarity &pose)
{
  if (count_ == ring_.size()) {
    std::rotate(ring_.begin(), ring_.begin() + static_cast<std::ptrdiff_t>(oldest_), ring_.end());
    oldest_ = 0;
    ring_.emplace_back();
  }
  Entry &added = entry(count_++);
  added.time = time;
  added.pose = pose;
  added.integral.create(current_.size(), CV_64FC1);
  return added;
}

/// Extends an integral by `duration` of the current map; `to` may be `from`.
void
TemporalPyramid::integrate(const Entry &from, double duration, Entry &to)
{
  to.integral.create(current_.size(), CV_64FC1);
  rows::integrate(from.integral.ptr<double>(), current_.ptr<float>(), duration, current_.total(),
                  to.integral.ptr<double>());
}

void
TemporalPyramid::push(const cv::Mat &map, double elapsed, double duration, const Similarity &pose)
{
  if (count_ == 0) {
    map.copyTo(current_);
    if (start_ == HistoryStart::filled) {
      Entry &before = add_entry(-longest_, pose);
      clear(before.integral);
      integrate(before, -longest_, before);
    }
    clear(add_entry(0, pose).integral);
  } else {
    const double on_show = std::min(elapsed, longest_);
    const double now = latest().time + on_show;
    if (count_ > 1 && latest().time - entry(count_ - 2).time < kShortestEntry) {
      Entry &last = entry(count_ - 1);
      integrate(last, on_show, last);
      last.time = now;
      last.pose = pose;
    } else {
      Entry &next = add_entry(now, pose);
      integrate(entry(count_ - 2), on_show, next);
    }
    while (entry(1).time <= now - longest_) {
      oldest_ = (oldest_ + 1) % ring_.size();
      --count_;
    }
    map.copyTo(current_);
  }

  const double displayed = std::min(duration, kLongestDisplay);
  end_.time = latest().time + displayed;
  integrate(latest(), displayed, end_);
}

void
TemporalPyramid::settle(const cv::Mat &share)
{
  const auto *part = share.ptr<float>();
  const auto *present = current_.ptr<float>();
  const auto *now = latest().integral.ptr<double>();
  for (std::size_t sample = 0; sample < share.total(); ++sample) {
    if (part[sample] <= 0)
      continue;
    for (std::size_t i = 0; i + 1 < count_; ++i) {
      double &past = entry(i).integral.ptr<double>()[sample];
      const double forever
          = now[sample] - (latest().time - entry(i).time) * static_cast<double>(present[sample]);
      if (past > forever)
        past += static_cast<double>(part[sample]) * (forever - past);
    }
  }
}

void
TemporalPyramid::rebase(const Similarity &view)
{
  for (std::size_t i = 0; i < count_; ++i)
    entry(i).pose = view * entry(i).pose;
}

bool
TemporalPyramid::moved() const
{
  for (std::size_t i = 0; i < count_; ++i)
    if (entry(i).pose != latest().pose)
      return true;
  return false;
}

void
TemporalPyramid::means(std::span<const int> windows, std::vector<cv::Mat> &maps, const Team &team)
{
  maps.resize(windows.size());
  if (moved()) {
    moved_means(windows, maps);
    return;
  }
  team.each(static_cast<int>(windows.size()), [&](int window) {
    const auto i = static_cast<std::size_t>(window);
    const double start = std::max(end_.time - windows[i], entry(0).time);
    difference(moment(start), moment(end_.time), 1 / (end_.time - start), maps[i]);
  });
}

std::size_t
TemporalPyramid::display_before(double time) const
{
  std::size_t i = count_ - 1;
  while (i > 0 && entry(i).time >= time)
    --i;
  return i;
}

TemporalPyramid::Moment
TemporalPyramid::moment(double time) const
{
  if (time >= end_.time)
    return { &end_, &end_, 0 };
  std::size_t i = count_ - 1;
  while (i > 0 && entry(i).time > time)
    --i;
  const Entry &from = entry(i);
  const Entry &to = i + 1 < count_ ? entry(i + 1) : end_;
  return { &from, &to, (time - from.time) / (to.time - from.time) };
}

/// The integral between two moments, times `scale`.
void
TemporalPyramid::difference(const Moment &from, const Moment &to, double scale, cv::Mat &map) const
{
  const auto integral = [](const Moment &moment) -> rows::Integral {
    return { moment.before->integral.ptr<double>(), moment.after->integral.ptr<double>(),
             moment.part };
  };
  map.create(current_.size(), CV_32FC1);
  rows::difference(integral(from), integral(to), scale, map.total(), map.ptr<float>());
}

/// Goes backward from the present in stretches. A stretch begins where a display does, once it
/// spans kShareOfAge of its age, or where a window begins.
void
TemporalPyramid::moved_means(std::span<const int> windows, std::vector<cv::Mat> &maps)
{
  sum_.create(current_.size(), CV_32FC1);
  std::fill_n(sum_.ptr<float>(), sum_.total(), 0.0F);
  double to = end_.time;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const double start = std::max(end_.time - windows[i], entry(0).time);
    while (to > start) {
      const double latest_begin = to - kShareOfAge * (end_.time - to);
      const double from = std::max(start, entry(display_before(latest_begin)).time);
      add_moved(from, to);
      to = from;
    }
    cv::scaleAdd(sum_, 1 / (end_.time - start), current_, maps[i]);
  }
}

/// Adds the integral from one time to another, less the current map, warped to the current pose.
void
TemporalPyramid::add_moved(double from, double to)
{
  difference(moment(from), moment(to), 1, stretch_);
  const auto length = static_cast<float>(to - from);
  const Similarity &then = entry(display_before((from + to) / 2)).pose;
  if (then == latest().pose) {
    sum_ += stretch_;
    cv::scaleAdd(current_, static_cast<double>(-length), sum_, sum_);
  } else {
    add_sampled(stretch_, then.inverse() * latest().pose, static_cast<float>(kBorder), current_,
                length, sum_);
  }
}

std::size_t
TemporalPyramid::size() const
{
  return count_;
}

} // namespace saliency
