/* SPDX-License-Identifier: LGPL-2.1-or-later */
#ifndef __GST_TACTILE_CAPS_H__
#define __GST_TACTILE_CAPS_H__

#include <gst/gst.h>
#include <gst/tactile/tactile-prelude.h>

G_BEGIN_DECLS

/**
 * GST_TACTILE_MAP_MEDIA_TYPE:
 *
 * Media type of a stream of tactile maps. A buffer is rows × columns levels in
 * [0, 1] as little-endian 32-bit floats, row-major, the top left tactor as seen
 * on the screen first. Its timestamp and duration are those of the frame.
 *
 * Since: 0.1
 */
#define GST_TACTILE_MAP_MEDIA_TYPE "application/x-tactile-map"

/**
 * GST_TACTILE_MAP_CAPS:
 *
 * Caps of a stream of tactile maps, for a pad template. A framerate of 0/1 means
 * unknown or variable.
 *
 * Since: 0.1
 */
#define GST_TACTILE_MAP_CAPS                                                                       \
  "application/x-tactile-map, rows = (int) [ 1, 64 ], columns = (int) [ 1, 64 ], framerate = "     \
  "(fraction) [ 0/1, max ]"

GST_TACTILE_API
GstCaps *gst_tactile_map_caps_new(guint rows, guint columns, gint fps_n, gint fps_d);

GST_TACTILE_API
gboolean gst_tactile_map_caps_parse(const GstCaps *caps, guint *rows, guint *columns, gint *fps_n,
                                    gint *fps_d);

GST_TACTILE_API
GstBuffer *gst_tactile_map_buffer_new(const gfloat *levels, gsize n_levels);

GST_TACTILE_API
gboolean gst_tactile_map_buffer_get_levels(GstBuffer *buffer, guint rows, guint columns,
                                           gfloat **levels, gsize *n_levels);

G_END_DECLS

#endif /* __GST_TACTILE_CAPS_H__ */
