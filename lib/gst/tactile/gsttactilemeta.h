/* SPDX-License-Identifier: LGPL-2.1-or-later */
#ifndef __GST_TACTILE_META_H__
#define __GST_TACTILE_META_H__

#include <gst/gst.h>
#include <gst/tactile/tactile-prelude.h>
#include <gst/video/video.h>

G_BEGIN_DECLS

#define GST_TACTILE_META_API_TYPE (gst_tactile_meta_api_get_type())
#define GST_TACTILE_META_INFO (gst_tactile_meta_get_info())

/**
 * GST_TACTILE_MAX_SIDE:
 *
 * Largest number of rows and largest number of columns of a grid of tactors.
 *
 * Since: 0.1
 */
#define GST_TACTILE_MAX_SIDE 64

typedef struct _GstTactileMeta GstTactileMeta;

/**
 * GstTactileMeta:
 * @meta: parent #GstMeta
 * @rows: rows of the grid of tactors, 1 to %GST_TACTILE_MAX_SIDE
 * @columns: columns of the grid of tactors, 1 to %GST_TACTILE_MAX_SIDE
 * @levels: (skip): @rows × @columns levels in [0, 1], row-major, the top left
 *     tactor as seen on the screen first
 *
 * The levels of a grid of tactors while this video frame is shown. The grid is
 * relative to the picture, so the meta stays unchanged when the frame is copied,
 * converted or scaled. Where an element flips, crops or boxes the picture, its
 * map is moved along if the element reports how (GStreamer 1.28), else dropped. A
 * buffer has at most one tactile map.
 *
 * Since: 0.1
 */
struct _GstTactileMeta
{
  GstMeta meta;

  guint rows;
  guint columns;
  gfloat *levels;
};

GST_TACTILE_API
GType gst_tactile_meta_api_get_type(void);

GST_TACTILE_API
const GstMetaInfo *gst_tactile_meta_get_info(void);

GST_TACTILE_API
GstTactileMeta *gst_buffer_add_tactile_meta(GstBuffer *buffer, guint rows, guint columns,
                                            const gfloat *levels, gsize n_levels);

GST_TACTILE_API
GstTactileMeta *gst_buffer_get_tactile_meta(GstBuffer *buffer);

GST_TACTILE_API
gfloat gst_tactile_meta_get_level(const GstTactileMeta *meta, guint row, guint column);

GST_TACTILE_API
const gfloat *gst_tactile_meta_get_levels(const GstTactileMeta *meta, gsize *n_levels);

GST_TACTILE_API
void gst_buffer_set_tactile_frequency(GstBuffer *buffer, gfloat frequency);

GST_TACTILE_API
gfloat gst_buffer_get_tactile_frequency(GstBuffer *buffer);

GST_TACTILE_API
void gst_tactile_meta_set_video_direction(GstTactileMeta *meta,
                                          GstVideoOrientationMethod direction);

G_END_DECLS

#endif /* __GST_TACTILE_META_H__ */
