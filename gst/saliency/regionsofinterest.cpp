// SPDX-License-Identifier: LGPL-2.1-or-later
#include "regionsofinterest.h"

#include <gst/video/video.h>

std::vector<saliency::Region>
regions_of_interest(GstBuffer *buffer, int left, int top, const saliency::RegionWeights &weights)
{
  std::vector<saliency::Region> regions;
  gpointer state = nullptr;
  while (GstMeta *meta = gst_buffer_iterate_meta_filtered(
             buffer, &state, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE)) {
    const auto *region = reinterpret_cast<const GstVideoRegionOfInterestMeta *>(meta);
    const gchar *type = g_quark_to_string(region->roi_type);
    const double weight = weights.of(type ? type : "");
    if (weight != 1)
      regions.push_back(
          { .area = cv::Rect2d(static_cast<double>(region->x) - left,
                               static_cast<double>(region->y) - top, region->w, region->h),
            .type = region->roi_type,
            .weight = weight });
  }
  return regions;
}
