// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "../cameramode.h"
#include "../peoplemode.h"
#include "../properties.h"
#include "saliency/region_weights.h"
#include "tactile/cue_limiter.h"
#include "tactile/tactile_mapping.h"

#include <gst/video/video.h>

#include <memory>
#include <string>

enum class ProfileName
{
  tuned,
  paper,
};

enum class ViewportMode
{
  fixed,
  adaptive,
};

/// The properties of saliencytactile. Not thread-safe.
struct SaliencySettings
{
  static constexpr double kProfiles = -1; ///< the profile's own

  ProfileName profile = ProfileName::tuned;
  int rows = 3;
  int columns = 3;
  bool has_grid = false; ///< rows or columns were set; else downstream may prefer others
  bool temporal = true;
  double threshold = tactile::MappingSettings().threshold;
  double center_weight = kProfiles;
  double floor = kProfiles;
  double sensitivity = 1;
  double density = 0;
  std::shared_ptr<const saliency::RegionWeights> roi_weights; ///< null: 1 for every type
  std::string roi_weights_error; ///< why the last text was refused; empty: it was not
  ViewportMode viewport = ViewportMode::fixed;
  CameraMode camera = CameraMode::off;
  GstVideoOrientationMethod video_direction = GST_VIDEO_ORIENTATION_AUTO;
  tactile::CueLimits cue_limits;
  bool attach_saliency = false;
  double max_rate = 0;
  bool skip_unchanged = true;
  bool keep_maps = false;
  int n_threads = 0; ///< 0: by frame size and processor
  bool exact = false;
  PeopleMode people = PeopleMode::automatic;

  /// All properties of saliencytactile.
  static void install(GObjectClass *klass, const properties::Element<SaliencySettings> &element);
};
