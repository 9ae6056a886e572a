// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gst/video/video_direction.h"

void
OrientationTags::follow(GstEvent *event)
{
  if (GST_EVENT_TYPE(event) == GST_EVENT_STREAM_START) {
    const gchar *id = nullptr;
    gst_event_parse_stream_start(event, &id);
    if (stream_id_ != (id ? id : "")) {
      reset();
      stream_id_ = id ? id : "";
    }
    return;
  }
  if (GST_EVENT_TYPE(event) != GST_EVENT_TAG)
    return;
  GstTagList *tags = nullptr;
  gst_event_parse_tag(event, &tags);
  GstVideoOrientationMethod method;
  if (!gst_video_orientation_from_tag(tags, &method))
    method = kUnsaid;
  (gst_tag_list_get_scope(tags) == GST_TAG_SCOPE_GLOBAL ? global_ : stream_) = method;
}

void
OrientationTags::reset()
{
  *this = {};
}

GstVideoOrientationMethod
OrientationTags::method() const
{
  const GstVideoOrientationMethod said = stream_ != kUnsaid ? stream_ : global_;
  return said != kUnsaid ? said : GST_VIDEO_ORIENTATION_IDENTITY;
}

tactile::Orientation
orientation_of(GstVideoOrientationMethod wanted, const OrientationTags &tags)
{
  switch (wanted == GST_VIDEO_ORIENTATION_AUTO ? tags.method() : wanted) {
  case GST_VIDEO_ORIENTATION_90R:
    return { .transposed = true, .mirrored_rows = true, .mirrored_columns = false };
  case GST_VIDEO_ORIENTATION_180:
    return { .transposed = false, .mirrored_rows = true, .mirrored_columns = true };
  case GST_VIDEO_ORIENTATION_90L:
    return { .transposed = true, .mirrored_rows = false, .mirrored_columns = true };
  case GST_VIDEO_ORIENTATION_HORIZ:
    return { .transposed = false, .mirrored_rows = false, .mirrored_columns = true };
  case GST_VIDEO_ORIENTATION_VERT:
    return { .transposed = false, .mirrored_rows = true, .mirrored_columns = false };
  case GST_VIDEO_ORIENTATION_UL_LR:
    return { .transposed = true, .mirrored_rows = false, .mirrored_columns = false };
  case GST_VIDEO_ORIENTATION_UR_LL:
    return { .transposed = true, .mirrored_rows = true, .mirrored_columns = true };
  default:
    return {};
  }
}

GstVideoOrientationMethod
direction_at(GstPad *pad)
{
  OrientationTags tags;
  for (guint i = 0; GstEvent *event = gst_pad_get_sticky_event(pad, GST_EVENT_TAG, i); i++) {
    tags.follow(event);
    gst_event_unref(event);
  }
  return tags.method();
}
