/* SPDX-License-Identifier: LGPL-2.1-or-later */
#ifndef __GST_SALIENCY_META_H__
#define __GST_SALIENCY_META_H__

#include <gst/gst.h>
#include <gst/tactile/tactile-prelude.h>

G_BEGIN_DECLS

#define GST_SALIENCY_META_API_TYPE (gst_saliency_meta_api_get_type())
#define GST_SALIENCY_META_INFO (gst_saliency_meta_get_info())

/**
 * GST_SALIENCY_MAX_SIDE:
 *
 * Largest width and largest height of a saliency map, in values.
 *
 * Since: 0.1
 */
#define GST_SALIENCY_MAX_SIDE 4096

typedef struct _GstSaliencyMeta GstSaliencyMeta;

/**
 * GstSaliencyMeta:
 * @meta: parent #GstMeta
 * @width: columns of the map, 1 to %GST_SALIENCY_MAX_SIDE
 * @height: rows of the map, 1 to %GST_SALIENCY_MAX_SIDE
 * @values: (skip): @width × @height values, at least 0, row-major from the top
 *     left, in the units of the analysis
 * @floor: in the same units: a map whose maximum does not exceed it is silent
 *
 * The saliency map of a video frame. It covers the whole picture at a resolution
 * of its own, so it stays unchanged when the frame is copied, converted or
 * scaled. The center of value (x, y) lies at ((x + ½) / @width,
 * (y + ½) / @height) of the picture. The map can therefore be resized to the
 * picture like any image. A buffer has at most one saliency map.
 *
 * Since: 0.1
 */
struct _GstSaliencyMeta
{
  GstMeta meta;

  guint width;
  guint height;
  gfloat *values;
  gfloat floor;
};

GST_TACTILE_API
GType gst_saliency_meta_api_get_type(void);

GST_TACTILE_API
const GstMetaInfo *gst_saliency_meta_get_info(void);

GST_TACTILE_API
GstSaliencyMeta *gst_buffer_add_saliency_meta(GstBuffer *buffer, guint width, guint height,
                                              const gfloat *values, gsize n_values, gfloat floor);

GST_TACTILE_API
GstSaliencyMeta *gst_buffer_get_saliency_meta(GstBuffer *buffer);

GST_TACTILE_API
gfloat gst_saliency_meta_get_value(const GstSaliencyMeta *meta, guint x, guint y);

GST_TACTILE_API
const gfloat *gst_saliency_meta_get_values(const GstSaliencyMeta *meta, gsize *n_values);

G_END_DECLS

#endif /* __GST_SALIENCY_META_H__ */
