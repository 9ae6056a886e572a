// SPDX-License-Identifier: LGPL-2.1-or-later
#include "regionsofinterest.h"

#include <gst/video/video.h>

#ifdef HAVE_ANALYTICS
#include <gst/analytics/analytics.h>
#endif

#include <string_view>

namespace {

cv::Rect2d
placed(const Placement &view, double x, double y, double width, double height)
{
  return { view.offset_x + view.scale_x * x, view.offset_y + view.scale_y * y, view.scale_x * width,
           view.scale_y * height };
}

std::string_view
name_of(GQuark type)
{
  const gchar *name = g_quark_to_string(type);
  return name ? name : "";
}

#ifdef HAVE_ANALYTICS
/// Whether a tracker has lost an object: it is where it was.
bool
is_lost(GstAnalyticsRelationMeta *meta, guint object)
{
  gpointer state = nullptr;
  GstAnalyticsMtd track;
  while (gst_analytics_relation_meta_get_direct_related(meta, object, GST_ANALYTICS_REL_TYPE_ANY,
                                                        gst_analytics_tracking_mtd_get_mtd_type(),
                                                        &state, &track)) {
    guint64 id = 0;
    GstClockTime first = 0;
    GstClockTime last = 0;
    gboolean lost = FALSE;
    if (gst_analytics_tracking_mtd_get_info(&track, &id, &first, &last, &lost) && lost)
      return true;
  }
  return false;
}

template <typename Use>
void
each_object(GstBuffer *frame, const Placement &view, const Use &use)
{
  GstAnalyticsRelationMeta *meta = gst_buffer_get_analytics_relation_meta(frame);
  gpointer state = nullptr;
  GstAnalyticsMtd object;
  while (meta != nullptr
         && gst_analytics_relation_meta_iterate(meta, &state, gst_analytics_od_mtd_get_mtd_type(),
                                                &object)) {
    gint x = 0;
    gint y = 0;
    gint width = 0;
    gint height = 0;
    gfloat confidence = 0;
    const GQuark type = gst_analytics_od_mtd_get_obj_type(&object);
    if (gst_analytics_od_mtd_get_location(&object, &x, &y, &width, &height, &confidence)
        && !is_lost(meta, object.id))
      use(type, name_of(type), placed(view, x, y, width, height));
  }
}
#endif

template <typename Use>
void
each_region(GstBuffer *frame, const Placement &view, const Use &use)
{
  gpointer state = nullptr;
  while (GstMeta *meta = gst_buffer_iterate_meta_filtered(
             frame, &state, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE)) {
    const auto *region = reinterpret_cast<const GstVideoRegionOfInterestMeta *>(meta);
    use(region->roi_type, name_of(region->roi_type),
        placed(view, region->x, region->y, region->w, region->h));
  }
#ifdef HAVE_ANALYTICS
  each_object(frame, view, use);
#endif
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
