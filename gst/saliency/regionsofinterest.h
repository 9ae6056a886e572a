// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frameshrinker.h"
#include "saliency/region_weights.h"
#include "saliency/top_down_saliency.h"

#include <gst/gst.h>

#include <vector>

/// Boxes of people that detectors upstream found, of types `face`, `head` and `person`, as below.
std::vector<cv::Rect2d> people_of_interest(GstBuffer *frame, const Placement &view);

/// Regions that detectors upstream found, from GstVideoRegionOfInterestMeta and, since GStreamer
/// 1.24, the objects of GstAnalyticsRelationMeta, with their weights; regions of weight 1 are left
/// out, as are objects that a tracker has lost. Coordinates are pixels of the `view` that is
/// analyzed.
std::vector<saliency::Region> regions_of_interest(GstBuffer *frame, const Placement &view,
                                                  const saliency::RegionWeights &weights);
