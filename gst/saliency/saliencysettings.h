// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/region_weights.h"
#include "tactile/cue_limiter.h"

#include <gst/video/video.h>

#include <memory>
#include <string>

/// saliencytactile's properties.
enum SaliencyProperty : guint
{
  SALIENCY_PROP_PROFILE = 1,
  SALIENCY_PROP_ROWS,
  SALIENCY_PROP_COLUMNS,
  SALIENCY_PROP_TEMPORAL,
  SALIENCY_PROP_THRESHOLD,
  SALIENCY_PROP_FLOOR,
  SALIENCY_PROP_ROI_WEIGHTS,
  SALIENCY_PROP_VIEWPORT,
  SALIENCY_PROP_VIDEO_DIRECTION,
  SALIENCY_PROP_MAX_CUE_DURATION,
  SALIENCY_PROP_CUE_REFRACTORY,
  SALIENCY_PROP_ATTACH_SALIENCY,
  SALIENCY_PROP_MAX_RATE,
  SALIENCY_PROP_KEEP_MAPS,
  SALIENCY_PROP_N_THREADS,
  SALIENCY_PROP_EXACT,
  SALIENCY_PROP_STATS,
};

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

/// What the user of saliencytactile sets, and how that looks as properties of a GObject. Not
/// thread-safe: the element guards it.
struct SaliencySettings
{
  /// A floor that is not set is the profile's own.
  static constexpr double kProfileFloor = -1;

  ProfileName profile = ProfileName::tuned;
  int rows = 3;
  int columns = 3;
  bool temporal = true;
  double threshold = 0.5;
  double floor = kProfileFloor;
  std::shared_ptr<const saliency::RegionWeights> roi_weights; ///< none: no type has one
  /// Why the last text for roi_weights was refused, which left them as they were; empty if it was
  /// not.
  std::string roi_weights_error;
  ViewportMode viewport = ViewportMode::fixed;
  GstVideoOrientationMethod video_direction = GST_VIDEO_ORIENTATION_AUTO;
  tactile::CueLimits cue_limits;
  bool attach_saliency = false;
  double max_rate = 0;
  bool keep_maps = false;
  int n_threads = 0; ///< 0: as many as pay
  bool exact = false;

  /// All of SaliencyProperty, with their texts, ranges and defaults.
  static void install(GObjectClass *klass);

  /// Sets or gets a property. False if it is none of these: SALIENCY_PROP_STATS is the element's
  /// own.
  bool set(guint id, const GValue *value);
  bool get(guint id, GValue *value) const;

private:
  void set_roi_weights(const gchar *text); ///< null: none
};
