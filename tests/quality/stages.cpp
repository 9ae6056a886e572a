// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stages.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>

namespace quality {

namespace {

double
longest_window(const saliency::Profile &profile)
{
  int longest = 1;
  for (const auto &pair : profile.windows)
    longest = std::max({ longest, pair.center, pair.surround });
  return longest;
}

double
in_frames(saliency::Time time)
{
  return static_cast<double>(time.count()) * 30e-9;
}

} // namespace

const char *
name(Stage stage)
{
  switch (stage) {
  case Stage::pyramid:
    return "pyramid";
  case Stage::camera:
    return "camera";
  case Stage::shot_cut:
    return "shot cut";
  case Stage::spatial:
    return "contrast";
  case Stage::history:
    return "history";
  case Stage::spatiotemporal:
    return "temporal";
  }
  return "";
}

Stages::Stages(const saliency::Profile &profile, cv::Size frame)
    : profile_(profile), levels_(saliency::frame_levels(profile, frame)), shot_cut_(profile),
      spatial_(profile), history_(longest_window(profile), profile.history_start),
      spatiotemporal_(profile)
{
}

saliency::Similarity
Stages::camera_pose(double elapsed)
{
  if (!profile_.camera_motion)
    return {};
  const int level = std::max(levels_.finest, levels_.saliency - 1);
  return camera_.follow(pyramid_.level(level).lightness(), elapsed)
      .in_units_of(std::ldexp(1.0, levels_.saliency - level));
}

const saliency::Saliency &
Stages::analyze(const saliency::LabImage &lab, saliency::Time time, saliency::Time duration,
                bool temporal, const Done &done)
{
  pyramid_.build(lab, levels_.finest, levels_.coarsest);
  return analyze_pyramid(time, duration, temporal, done);
}

const saliency::Saliency &
Stages::analyze(const saliency::FixedLabImage &lab, saliency::Time time, saliency::Time duration,
                bool temporal, const Done &done)
{
  pyramid_.build(lab, levels_.finest, levels_.coarsest, levels_.finest_chroma);
  return analyze_pyramid(time, duration, temporal, done);
}

const saliency::Saliency &
Stages::analyze_pyramid(saliency::Time time, saliency::Time duration, bool temporal,
                        const Done &done)
{
  const auto finish = [&](Stage stage) {
    if (done)
      done(stage);
  };
  double elapsed = first_ ? 0 : in_frames(time - last_);
  finish(Stage::pyramid);
  saliency::Similarity pose = camera_pose(elapsed);
  finish(Stage::camera);
  result_.cut
      = profile_.cut_share < 1 && shot_cut_(pyramid_.level(levels_.saliency)) && !camera_.moved();
  if (result_.cut) {
    history_.reset();
    camera_.reset();
    elapsed = 0;
    pose = camera_pose(elapsed);
  }
  finish(Stage::shot_cut);
  spatial_map_ = spatial_.compute(pyramid_, levels_);
  finish(Stage::spatial);
  if (profile_.time_base == saliency::TimeBase::frames)
    history_.push(spatial_map_, 1, 1);
  else
    history_.push(spatial_map_, elapsed, in_frames(duration), pose);
  finish(Stage::history);
  result_.map = temporal ? spatiotemporal_.compute(history_) : spatial_map_;
  result_.camera_moves = history_.moved();
  cv::minMaxLoc(result_.map, nullptr, &result_.peak);
  const double step = std::ldexp(1.0, levels_.saliency);
  result_.picture = { 0.5 - 0.5 / step, 0.5 - 0.5 / step, levels_.frame.width / step,
                      levels_.frame.height / step };
  finish(Stage::spatiotemporal);
  first_ = false;
  last_ = time;
  return result_;
}

} // namespace quality
