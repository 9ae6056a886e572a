// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/analyzer.h"
#include "saliency/camera_motion.h"
#include "saliency/profile.h"
#include "saliency/pyramid.h"
#include "saliency/shot_cut.h"
#include "saliency/spatial_saliency.h"
#include "saliency/spatiotemporal_saliency.h"
#include "saliency/temporal_pyramid.h"

#include <opencv2/core/mat.hpp>

#include <array>
#include <functional>

namespace quality {

/// What saliency::Analyzer does with a frame once there is an L*a*b* image of it, in this order.
enum class Stage
{
  pyramid,
  camera,
  shot_cut,
  spatial,
  history,
  spatiotemporal,
};
inline constexpr std::array kStages{ Stage::pyramid, Stage::camera,  Stage::shot_cut,
                                     Stage::spatial, Stage::history, Stage::spatiotemporal };

const char *name(Stage stage);

/// The stages of saliency::Analyzer one by one, for L*a*b* images from elsewhere and for timing.
/// The same map to the bit (tests/check/libs/stages.cpp), for frames that follow one another
/// without a hole and cameras that stay in sight of where they began.
class Stages
{
public:
  using Done = std::function<void(Stage)>;

  Stages(const saliency::Profile &profile, cv::Size frame);

  /// Of the L*a*b* image that analyze() expects, in octaves below the frame's size.
  int level() const
  {
    return levels_.finest;
  }
  const saliency::FrameLevels &levels() const
  {
    return levels_;
  }

  /// `lab`: at level(), from anywhere or a front end's. `done` is called after each stage.
  const saliency::Saliency &analyze(const saliency::LabImage &lab, saliency::Time time,
                                    saliency::Time duration, bool temporal = true,
                                    const Done &done = {});
  const saliency::Saliency &analyze(const saliency::FixedLabImage &lab, saliency::Time time,
                                    saliency::Time duration, bool temporal = true,
                                    const Done &done = {});

  /// The spatial map of the last frame.
  const cv::Mat &spatial() const
  {
    return spatial_map_;
  }

private:
  const saliency::Saliency &analyze_pyramid(saliency::Time time, saliency::Time duration,
                                            bool temporal, const Done &done);
  saliency::Similarity camera_pose(double elapsed);

  saliency::Profile profile_;
  saliency::FrameLevels levels_;
  saliency::Pyramid pyramid_;
  saliency::CameraMotion camera_;
  saliency::ShotCut shot_cut_;
  saliency::SpatialSaliency spatial_;
  saliency::TemporalPyramid history_;
  saliency::SpatiotemporalSaliency spatiotemporal_;
  bool first_ = true;
  saliency::Time last_{ 0 };
  cv::Mat spatial_map_;
  saliency::Saliency result_;
};

} // namespace quality
