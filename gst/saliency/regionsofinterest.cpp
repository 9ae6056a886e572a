// SPDX-License-Identifier: LGPL-2.1-or-later
#include "regionsofinterest.h"

#include <gst/video/video.h>

#include <string_view>

namespace {

template <typename Use>
void
each_region(GstBuffer *frame, const Placement &view, const Use &use)
{
  gpointer state = nullptr;
  while (GstMeta *meta = gst_buffer_iterate_meta_filtered(
             frame, &state, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE)) {
    const auto *region = reinterpret_cast<const GstVideoRegionOfInterestMeta *>(meta);
    const gchar *type = g_quark_to_string(region->roi_type);
    use(region->roi_type, std::string_view(type ? type : ""),
        cv::Rect2d(view.offset_x + view.scale_x * region->x,
                   view.offset_y + view.scale_y * region->y, view.scale_x * region->w,
                   view.scale_y * region->h));
  }
}

} // namespace

std::vector<cv::Rect2d>
people_of_interest(GstBuffer *frame, const Placement &view)
{
  std::vector<cv::Rect2d> boxes;
  each_region(frame, view, [&](GQuark, std::string_view type, const cv::Rect2d &area) {
    if ((type == "face" || type == "head" || type == "person") && !area.empty())
      boxes.push_back(area);
  });
  return boxes;
}

std::vector<saliency::Region>
regions_of_interest(GstBuffer *frame, const Placement &view, const saliency::RegionWeights &weights)
{
  std::vector<saliency::Region> regions;
  each_region(frame, view, [&](GQuark id, std::string_view type, const cv::Rect2d &area) {
    const double weight = weights.of(type);
    if (weight != 1)
      regions.push_back({ .area = area, .type = id, .weight = weight });
  });
  return regions;
}
