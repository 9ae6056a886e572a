// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/top_down_saliency.h"

#include "saliency/events/event_map.h"
#include "saliency/paper.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace saliency {

namespace {

/// One frame at 30 fps.
constexpr Time kFrame = Time(std::chrono::seconds(1)) / 30;

double
reach_of(const Profile &profile)
{
  const bool paper = profile.method == Method::paper;
  const int coarsest = paper ? Paper::kCenters.back() : profile.levels.center;
  const int map = paper ? Paper::kSaliencyLevel : profile.saliency_level;
  return std::ldexp(2.0, std::max(coarsest - map, 0));
}

/// For how long past content still raises the map.
Time
hold_of(const Profile &profile)
{
  const int frames = profile.method == Method::paper ? Paper::kFrames : EventMap::kHold;
  return frames * Time(std::chrono::seconds(1)) / 30;
}

/// An axis of the map, and the extent of the picture along it in samples.
struct Axis
{
  int samples;
  double picture_begin;
  double picture_end;
};

/// The samples covered by a region along an axis: their shares, starting at sample `first`.
struct Cover
{
  int first = 0;
  std::vector<float> shares;
};

/// The share of each sample's part of the picture that lies in [begin, end), in samples. The
/// outermost samples also stand for the picture beyond them.
Cover
cover(const Axis &axis, double begin, double end)
{
  Cover cover;
  for (int i = 0; i < axis.samples; ++i) {
    const double sample_begin = i == 0 ? axis.picture_begin : i;
    const double sample_end = i + 1 == axis.samples ? axis.picture_end : i + 1;
    const double covered = std::min(end, sample_end) - std::max(begin, sample_begin);
    if (!(covered > 0))
      continue;
    if (cover.shares.empty())
      cover.first = i;
    cover.shares.push_back(static_cast<float>(covered / (sample_end - sample_begin)));
  }
  return cover;
}

} // namespace

TopDownSaliency::TopDownSaliency(const Profile &profile, bool temporal)
    : reach_(reach_of(profile)), hold_(temporal ? hold_of(profile) : Time{}),
      in_frames_(profile.method == Method::paper),
      events_(temporal && profile.method != Method::paper)
{
}

double
TopDownSaliency::reach(cv::Size map) const
{
  return events_ ? reach_ + EventMap::reach(map) : reach_;
}

const cv::Mat &
TopDownSaliency::compute(const Saliency &found, cv::Size frame, std::span<const Region> regions,
                         Time time)
{
  if ((last_time_ && time < *last_time_) || frame != frame_)
    reset();
  const Time elapsed = in_frames_ ? kFrame : time - last_time_.value_or(time);
  last_time_ = time;
  frame_ = frame;
  for (Remembered &remembered : regions_)
    remembered.age += elapsed;
  while (!regions_.empty() && regions_.back().age > hold_)
    regions_.pop_back();
  for (const Region &region : regions)
    // A region entirely outside the picture does not reach into it.
    if (!(region.area & cv::Rect2d(0, 0, frame.width, frame.height)).empty())
      regions_.push_front({ region, Time{} });
  if (regions_.size() > kMaxRegions)
    regions_.resize(kMaxRegions);
  if (regions_.empty())
    return found.map;

  std::vector<Region> by_type;
  for (const Remembered &remembered : regions_)
    by_type.push_back(remembered.region);
  std::ranges::stable_sort(by_type, {}, &Region::type);

  found.map.copyTo(map_);
  covered_.create(map_.size());
  const cv::Rect2d &picture = found.picture;
  const Axis horizontal{ map_.cols, picture.x, picture.x + picture.width };
  const Axis vertical{ map_.rows, picture.y, picture.y + picture.height };
  const double reach = this->reach(map_.size());
  const double step_x = picture.width / frame.width; // samples per pixel
  const double step_y = picture.height / frame.height;
  for (auto region = by_type.begin(); region != by_type.end();) {
    const unsigned type = region->type;
    const auto change = static_cast<float>(region->weight - 1); // the newest region counts
    covered_.setTo(0);
    for (; region != by_type.end() && region->type == type; ++region) {
      const double x = picture.x + region->area.x * step_x;
      const double y = picture.y + region->area.y * step_y;
      const Cover columns = cover(horizontal, x - reach, x + region->area.width * step_x + reach);
      const Cover rows = cover(vertical, y - reach, y + region->area.height * step_y + reach);
      for (std::size_t r = 0; r < rows.shares.size(); ++r) {
        float *line = covered_[rows.first + static_cast<int>(r)] + columns.first;
        for (std::size_t c = 0; c < columns.shares.size(); ++c)
          line[c] = std::max(line[c], rows.shares[r] * columns.shares[c]);
      }
    }
    for (int y = 0; y < map_.rows; ++y)
      for (int x = 0; x < map_.cols; ++x)
        map_.at<float>(y, x) *= 1 + covered_(y, x) * change;
  }
  return map_;
}

void
TopDownSaliency::reset()
{
  regions_.clear();
  last_time_.reset();
}

} // namespace saliency
