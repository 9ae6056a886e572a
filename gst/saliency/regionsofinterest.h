// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/region_weights.h"
#include "saliency/top_down_saliency.h"

#include <gst/gst.h>

#include <vector>

/// What detectors upstream have found in a frame, as GstVideoRegionOfInterestMeta, and what it
/// counts; regions of weight 1 are left out. Coordinates are those of the part of the frame that
/// begins at pixel (left, top): what a GstVideoCropMeta leaves of it.
std::vector<saliency::Region> regions_of_interest(GstBuffer *buffer, int left, int top,
                                                  const saliency::RegionWeights &weights);
