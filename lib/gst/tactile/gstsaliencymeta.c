/* SPDX-License-Identifier: LGPL-2.1-or-later */

/**
 * SECTION:gstsaliencymeta
 * @title: GstSaliencyMeta
 * @short_description: the saliency map of a video frame
 *
 * `saliencytactile attach-saliency=true` adds a #GstSaliencyMeta to every frame
 * that it analyzes. `tactileoverlay` or an application can then show what the
 * tactile map was made from.
 */

#include "gstsaliencymeta.h"

#include "gsttactileplacement.h"

#include <gst/video/gstvideometa.h>
#include <math.h>

static gboolean
gst_saliency_meta_init(GstMeta *meta, gpointer params, GstBuffer *buffer)
{
  GstSaliencyMeta *self = (GstSaliencyMeta *)meta;

  self->width = 0;
  self->height = 0;
  self->values = NULL;
  self->floor = 0;
  return TRUE;
}

static void
gst_saliency_meta_free(GstMeta *meta, GstBuffer *buffer)
{
  GstSaliencyMeta *self = (GstSaliencyMeta *)meta;

  g_clear_pointer(&self->values, g_free);
}

static gboolean
gst_saliency_meta_transform(GstBuffer *dest, GstMeta *meta, GstBuffer *buffer, GQuark type,
                            gpointer data)
{
  const GstSaliencyMeta *self = (const GstSaliencyMeta *)meta;
  const gsize n_values = (gsize)self->width * self->height;
  GstTactilePlacement placement;
  guint width = self->width;
  guint height = self->height;
  gfloat *moved = NULL;
  gboolean added;

  /* The map covers the whole picture as it is stored, at a resolution of its own. A copy of a
   * region copies a range of bytes, not a part of the picture, so it keeps the whole map. */
  if (!GST_META_TRANSFORM_IS_COPY(type) && !GST_VIDEO_META_TRANSFORM_IS_SCALE(type)) {
    if (!gst_tactile_placement_init(&placement, type, data, GST_VIDEO_ORIENTATION_IDENTITY))
      return FALSE;
    if (gst_tactile_placement_is_transposed(&placement)) {
      width = self->height;
      height = self->width;
    }
    moved = g_new(gfloat, n_values);
    gst_tactile_placement_apply(&placement, self->height, self->width, self->values, height, width,
                                moved);
  }
  added = gst_buffer_add_saliency_meta(dest, width, height, moved ? moved : self->values, n_values,
                                       self->floor)
          != NULL;
  g_free(moved);
  return added;
}

/**
 * gst_saliency_meta_api_get_type: (skip)
 *
 * Gets the #GType of the metadata API, for gst_buffer_get_meta() and
 * gst_buffer_iterate_meta_filtered().
 *
 * Returns: the type of the #GstSaliencyMeta API. Its tags are `video`, `size` and
 *     `orientation`, as those of #GstTactileMeta
 *
 * Since: 0.1
 */
GType
gst_saliency_meta_api_get_type(void)
{
  static GType type = 0;
  static const gchar *tags[] = { GST_META_TAG_VIDEO_STR, GST_META_TAG_VIDEO_SIZE_STR,
                                 GST_META_TAG_VIDEO_ORIENTATION_STR, NULL };

  if (g_once_init_enter(&type)) {
    GType registered = gst_meta_api_type_register("GstSaliencyMetaAPI", tags);
    g_once_init_leave(&type, registered);
  }
  return type;
}

/**
 * gst_saliency_meta_get_info: (skip)
 *
 * Gets the #GstMetaInfo of the implementation, for gst_buffer_add_meta().
 *
 * Returns: the #GstMetaInfo of #GstSaliencyMeta
 *
 * Since: 0.1
 */
const GstMetaInfo *
gst_saliency_meta_get_info(void)
{
  static const GstMetaInfo *info = NULL;

  if (g_once_init_enter(&info)) {
    const GstMetaInfo *registered = gst_meta_register(
        GST_SALIENCY_META_API_TYPE, "GstSaliencyMeta", sizeof(GstSaliencyMeta),
        gst_saliency_meta_init, gst_saliency_meta_free, gst_saliency_meta_transform);
    g_once_init_leave(&info, registered);
  }
  return info;
}

/**
 * gst_buffer_add_saliency_meta:
 * @buffer: a writable #GstBuffer
 * @width: columns of the map, 1 to %GST_SALIENCY_MAX_SIDE
 * @height: rows of the map, 1 to %GST_SALIENCY_MAX_SIDE
 * @values: (array length=n_values): values of at least 0, row-major from the
 *     top left, in the units of the analysis. They are copied; values that are
 *     negative or not finite become 0
 * @n_values: number of @values: @width × @height
 * @floor: in the same units, finite and at least 0: a map whose maximum does not
 *     exceed it is silent
 *
 * Attaches a saliency map to a video frame. A frame has one saliency map: if
 * @buffer already has a #GstSaliencyMeta, its contents are replaced.
 *
 * Returns: (transfer none) (nullable): the #GstSaliencyMeta on @buffer, or %NULL
 *     if a parameter is out of range
 *
 * Since: 0.1
 */
GstSaliencyMeta *
gst_buffer_add_saliency_meta(GstBuffer *buffer, guint width, guint height, const gfloat *values,
                             gsize n_values, gfloat floor)
{
  GstSaliencyMeta *self;
  gfloat *copy;

  g_return_val_if_fail(GST_IS_BUFFER(buffer), NULL);
  g_return_val_if_fail(gst_buffer_is_writable(buffer), NULL);
  g_return_val_if_fail(width >= 1 && width <= GST_SALIENCY_MAX_SIDE, NULL);
  g_return_val_if_fail(height >= 1 && height <= GST_SALIENCY_MAX_SIDE, NULL);
  g_return_val_if_fail(values != NULL, NULL);
  g_return_val_if_fail(n_values == (gsize)width * height, NULL);
  g_return_val_if_fail(isfinite(floor) && floor >= 0, NULL);

  self = gst_buffer_get_saliency_meta(buffer);
  if (self == NULL)
    self = (GstSaliencyMeta *)gst_buffer_add_meta(buffer, GST_SALIENCY_META_INFO, NULL);
  if (self == NULL)
    return NULL;

  /* @values may belong to the meta that is replaced. */
  copy = g_new(gfloat, n_values);
  for (gsize i = 0; i < n_values; i++)
    copy[i] = isfinite(values[i]) && values[i] > 0 ? values[i] : 0.0f;

  g_free(self->values);
  self->values = copy;
  self->width = width;
  self->height = height;
  self->floor = floor;
  return self;
}

/**
 * gst_buffer_get_saliency_meta:
 * @buffer: a #GstBuffer
 *
 * Gets the saliency map of a video frame.
 *
 * Returns: (transfer none) (nullable): the #GstSaliencyMeta on @buffer, or %NULL
 *     if it has none
 *
 * Since: 0.1
 */
GstSaliencyMeta *
gst_buffer_get_saliency_meta(GstBuffer *buffer)
{
  g_return_val_if_fail(GST_IS_BUFFER(buffer), NULL);

  return (GstSaliencyMeta *)gst_buffer_get_meta(buffer, GST_SALIENCY_META_API_TYPE);
}

/**
 * gst_saliency_meta_get_value:
 * @meta: a #GstSaliencyMeta
 * @x: column of the map, counted from the left; less than its width
 * @y: row of the map, counted from the top; less than its height
 *
 * Gets one value of the map. Use gst_saliency_meta_get_values() for the whole
 * map.
 *
 * Returns: the value at (@x, @y), at least 0, in the units of the analysis
 *
 * Since: 0.1
 */
gfloat
gst_saliency_meta_get_value(const GstSaliencyMeta *meta, guint x, guint y)
{
  g_return_val_if_fail(meta != NULL, 0);
  g_return_val_if_fail(x < meta->width && y < meta->height, 0);

  return meta->values[(gsize)y * meta->width + x];
}

/**
 * gst_saliency_meta_get_values:
 * @meta: a #GstSaliencyMeta
 * @n_values: (out): number of values: width × height
 *
 * Gets all values of the map without copying them. The array is valid until the
 * meta is removed from its buffer or replaced.
 *
 * Returns: (array length=n_values) (transfer none): all values, at least 0,
 *     row-major from the top left
 *
 * Since: 0.1
 */
const gfloat *
gst_saliency_meta_get_values(const GstSaliencyMeta *meta, gsize *n_values)
{
  g_return_val_if_fail(meta != NULL, NULL);
  g_return_val_if_fail(n_values != NULL, NULL);

  *n_values = (gsize)meta->width * meta->height;
  return meta->values;
}
