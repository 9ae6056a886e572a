// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/surroundedness.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <span>

namespace saliency {

namespace {

/// Upper limit of |L*|, |a*| and |b*|.
constexpr double kLargest = 128;

/// A₀, as a share of the picture.
constexpr double kReferenceArea = 0.01;

/// 1 in fixed point: a weight added at the start of a run cancels exactly at its end.
constexpr double kOne = 1 << 20;

} // namespace

/// Iterates over the crossings of a threshold.
class Surroundedness::CrossingCursor
{
public:
  explicit CrossingCursor(std::span<const Crossing> crossings) : rest_(crossings)
  {
  }

  /// Whether row y has a crossing in columns [begin, end). Arguments must not decrease from call to
  /// call.
  bool find(int y, int begin, int end)
  {
    while (!rest_.empty()
           && (rest_.front().y < y || (rest_.front().y == y && rest_.front().x < begin)))
      rest_ = rest_.subspan(1);
    return !rest_.empty() && rest_.front().y == y && rest_.front().x < end;
  }

private:
  std::span<const Crossing> rest_;
};

Surroundedness::Surroundedness(double threshold_step, double area_exponent)
    : threshold_step_(threshold_step), area_exponent_(area_exponent)
{
  assert(threshold_step >= 0.5 && threshold_step <= 100);
  assert(area_exponent >= 0 && area_exponent <= 1);
  crossings_.resize(2 * static_cast<std::size_t>(std::ceil(kLargest / threshold_step)) + 1);
}

void
Surroundedness::prepare(cv::Size size)
{
  if (size != size_) {
    size_ = size;
    row_codes_.resize(static_cast<std::size_t>(size.height));
    row_runs_.resize(static_cast<std::size_t>(size.height) + 1);
    const double reference = kReferenceArea * size.area();
    weight_.assign(static_cast<std::size_t>(size.area()) + 1, 0);
    for (std::size_t area = 1; area < weight_.size(); ++area)
      weight_[area] = std::llround(
          kOne * threshold_step_ * std::pow(reference / static_cast<double>(area), area_exponent_));
  }
  change_.assign(static_cast<std::size_t>(size.area()), 0);
}

/// Sorts the crossings of a plane by threshold. Threshold k lies between codes k and k + 1.
void
Surroundedness::find_crossings(const cv::Mat &plane)
{
  for (auto &crossings : crossings_)
    crossings.clear();

  const auto last = static_cast<float>(crossings_.size());
  const std::size_t half = crossings_.size() / 2;
  const auto middle = static_cast<float>(half) + 0.5F;
  const auto scale = static_cast<float>(1 / threshold_step_);
  const auto code = [&](float value) {
    return static_cast<int>(std::min(std::max(value * scale + middle, 0.0F), last));
  };
  for (int y = 0; y < plane.rows; ++y) {
    const auto *row = plane.ptr<float>(y);
    int before = code(row[0]);
    row_codes_[static_cast<std::size_t>(y)] = before;
    for (int x = 1; x < plane.cols; ++x) {
      const int here = code(row[x]);
      for (int k = std::min(before, here); k < std::max(before, here); ++k)
        crossings_[static_cast<std::size_t>(k)].push_back({ x, y });
      before = here;
    }
  }
}

int
Surroundedness::run_end(int run, int y) const
{
  return run + 1 < row_runs_[static_cast<std::size_t>(y) + 1]
             ? runs_[static_cast<std::size_t>(run) + 1].x
             : size_.width;
}

int
Surroundedness::root(int run)
{
  auto *runs = runs_.data();
  while (runs[run].parent != run) {
    runs[run].parent = runs[runs[run].parent].parent;
    run = runs[run].parent;
  }
  return run;
}

void
Surroundedness::unite(int a, int b)
{
  a = root(a);
  b = root(b);
  if (a == b)
    return;
  auto &parent = runs_[static_cast<std::size_t>(std::min(a, b))];
  auto &child = runs_[static_cast<std::size_t>(std::max(a, b))];
  child.parent = std::min(a, b);
  parent.area += child.area;
  parent.border = parent.border || child.border;
  parent.beyond = parent.beyond || child.beyond;
}

/// Finds the connected regions above and below a threshold.
void
Surroundedness::join_runs(int threshold)
{
  runs_.clear();
  const auto add_run = [this](int x) {
    const int index = static_cast<int>(runs_.size());
    runs_.push_back({ x, index, 0, false, false });
  };
  const auto crossings_of = [this](int k) -> std::span<const Crossing> {
    if (k < 0 || k >= static_cast<int>(crossings_.size()))
      return {};
    return crossings_[static_cast<std::size_t>(k)];
  };
  const auto crossings = crossings_of(threshold);
  CrossingCursor higher(crossings_of(threshold + 1));
  CrossingCursor lower(crossings_of(threshold - 1));
  auto crossing = crossings.begin();
  for (int y = 0; y < size_.height; ++y) {
    const int first = static_cast<int>(runs_.size());
    row_runs_[static_cast<std::size_t>(y)] = first;
    add_run(0);
    for (; crossing != crossings.end() && crossing->y == y; ++crossing)
      add_run(crossing->x);
    const int end = static_cast<int>(runs_.size());
    row_runs_[static_cast<std::size_t>(y) + 1] = end;

    const bool outermost_row = y == 0 || y == size_.height - 1;
    bool above = row_codes_[static_cast<std::size_t>(y)] > threshold;
    for (int run = first; run < end; ++run, above = !above) {
      auto &r = runs_[static_cast<std::size_t>(run)];
      const int after = run_end(run, y);
      r.area = after - r.x;
      r.border = outermost_row || run == first || run == end - 1;
      // Inside the picture, a run beyond the next threshold has to cross it.
      r.beyond = (above ? higher : lower).find(y, r.x, after);
    }
    if (y == 0)
      continue;

    // Runs of both rows alternate between the two sides.
    int up = row_runs_[static_cast<std::size_t>(y) - 1];
    int down = first;
    bool same_side = (row_codes_[static_cast<std::size_t>(y) - 1] > threshold)
                     == (row_codes_[static_cast<std::size_t>(y)] > threshold);
    while (up < first && down < end) {
      if (same_side)
        unite(up, down);
      const int up_end = run_end(up, y - 1);
      const int down_end = run_end(down, y);
      if (up_end <= down_end)
        ++up;
      if (down_end <= up_end)
        ++down;
      if (up_end != down_end)
        same_side = !same_side;
    }
  }
}

void
Surroundedness::add_surrounded()
{
  auto *runs = runs_.data();
  auto *change = change_.data();
  for (int y = 0; y < size_.height; ++y, change += size_.width) {
    const int end = row_runs_[static_cast<std::size_t>(y) + 1];
    for (int run = row_runs_[static_cast<std::size_t>(y)]; run < end; ++run) {
      // Parents come before children, so the parent already points to its root.
      runs[run].parent = runs[runs[run].parent].parent;
      const auto &region = runs[runs[run].parent];
      if (region.border || !region.beyond)
        continue;
      const auto weight = weight_[static_cast<std::size_t>(region.area)];
      change[runs[run].x] += weight;
      change[runs[run + 1].x] -= weight; // the row's last run touches the border
    }
  }
}

void
Surroundedness::operator()(const LabImage &lab, cv::Mat &map)
{
  CV_Assert(!lab.size().empty());
  prepare(lab.size());
  for (const cv::Mat &plane : lab.planes) {
    find_crossings(plane);
    for (std::size_t threshold = 0; threshold < crossings_.size(); ++threshold) {
      // Without crossings, every row lies in a region that touches the border.
      if (crossings_[threshold].empty())
        continue;
      join_runs(static_cast<int>(threshold));
      add_surrounded();
    }
  }

  map.create(lab.size(), CV_32FC1);
  const auto *change = change_.data();
  for (int y = 0; y < map.rows; ++y, change += map.cols) {
    auto *out = map.ptr<float>(y);
    std::int64_t sum = 0;
    for (int x = 0; x < map.cols; ++x) {
      sum += change[x];
      out[x] = static_cast<float>(static_cast<double>(sum) / kOne);
    }
  }
}

} // namespace saliency
