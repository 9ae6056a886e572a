/* SPDX-License-Identifier: LGPL-2.1-or-later */

/**
 * SECTION:gsttactilecaps
 * @title: Tactile maps as a stream
 * @short_description: caps and buffers of application/x-tactile-map
 *
 * A tactile stream carries the tactile maps of a film without its pictures. See
 * %GST_TACTILE_MAP_MEDIA_TYPE for the format of its buffers.
 */

#include "gsttactilecaps.h"

#include "gsttactilemeta.h"
#include <string.h>

static gfloat
clamp_level(gfloat level)
{
  return level > 0 ? MIN(level, 1.0f) : 0.0f; /* NaN > 0 is false */
}

static gboolean
is_grid(gint rows, gint columns)
{
  return rows >= 1 && rows <= GST_TACTILE_MAX_SIDE && columns >= 1
         && columns <= GST_TACTILE_MAX_SIDE;
}

/**
 * gst_tactile_map_caps_new:
 * @rows: rows of the grid of tactors, 1 to %GST_TACTILE_MAX_SIDE
 * @columns: columns of the grid of tactors, 1 to %GST_TACTILE_MAX_SIDE
 * @fps_n: numerator of the maps per second, 0 if unknown or variable
 * @fps_d: denominator of the maps per second, at least 1
 *
 * Creates the caps of a stream of tactile maps with this grid and rate.
 *
 * Returns: (transfer full) (nullable): new fixed caps of a stream of tactile
 *     maps, or %NULL if a parameter is out of range
 *
 * Since: 0.1
 */
GstCaps *
gst_tactile_map_caps_new(guint rows, guint columns, gint fps_n, gint fps_d)
{
  g_return_val_if_fail(rows >= 1 && rows <= GST_TACTILE_MAX_SIDE, NULL);
  g_return_val_if_fail(columns >= 1 && columns <= GST_TACTILE_MAX_SIDE, NULL);
  g_return_val_if_fail(fps_n >= 0 && fps_d >= 1, NULL);

  return gst_caps_new_simple(GST_TACTILE_MAP_MEDIA_TYPE, "rows", G_TYPE_INT, (gint)rows, "columns",
                             G_TYPE_INT, (gint)columns, "framerate", GST_TYPE_FRACTION, fps_n,
                             fps_d, NULL);
}

/**
 * gst_tactile_map_caps_parse:
 * @caps: any #GstCaps
 * @rows: (out) (optional): rows of the grid of tactors
 * @columns: (out) (optional): columns of the grid of tactors
 * @fps_n: (out) (optional): numerator of the maps per second, 0 if @caps have
 *     none
 * @fps_d: (out) (optional): denominator of the maps per second, 1 if @caps have
 *     none
 *
 * Parses the first structure of @caps. Unless all of it is valid, no output is
 * written.
 *
 * Returns: %TRUE if @caps describe a stream of tactile maps with a valid grid
 *
 * Since: 0.1
 */
gboolean
gst_tactile_map_caps_parse(const GstCaps *caps, guint *rows, guint *columns, gint *fps_n,
                           gint *fps_d)
{
  const GstStructure *structure;
  gint r, c, n = 0, d = 1;

  g_return_val_if_fail(GST_IS_CAPS(caps), FALSE);

  if (gst_caps_is_any(caps) || gst_caps_is_empty(caps))
    return FALSE;

  structure = gst_caps_get_structure(caps, 0);
  if (!gst_structure_has_name(structure, GST_TACTILE_MAP_MEDIA_TYPE)
      || !gst_structure_get_int(structure, "rows", &r)
      || !gst_structure_get_int(structure, "columns", &c) || !is_grid(r, c))
    return FALSE;
  if (gst_structure_has_field(structure, "framerate")
      && (!gst_structure_get_fraction(structure, "framerate", &n, &d) || n < 0))
    return FALSE;

  if (rows)
    *rows = (guint)r;
  if (columns)
    *columns = (guint)c;
  if (fps_n)
    *fps_n = n;
  if (fps_d)
    *fps_d = d;
  return TRUE;
}

/**
 * gst_tactile_map_buffer_new:
 * @levels: (array length=n_levels): levels in [0, 1], row-major, the top left
 *     tactor first. They are copied; values outside the range are clamped, NaN
 *     becomes 0
 * @n_levels: number of @levels, 1 to %GST_TACTILE_MAX_SIDE squared
 *
 * Creates a buffer of a tactile stream. It has no timestamp or duration; set
 * those of the frame that the map belongs to.
 *
 * Returns: (transfer full) (nullable): a new buffer of a tactile stream, or %NULL
 *     if a parameter is out of range
 *
 * Since: 0.1
 */
GstBuffer *
gst_tactile_map_buffer_new(const gfloat *levels, gsize n_levels)
{
  guint8 *data;

  g_return_val_if_fail(levels != NULL, NULL);
  g_return_val_if_fail(
      n_levels >= 1 && n_levels <= (gsize)GST_TACTILE_MAX_SIDE * GST_TACTILE_MAX_SIDE, NULL);

  data = g_malloc(n_levels * sizeof(gfloat));
  for (gsize i = 0; i < n_levels; i++)
    GST_WRITE_FLOAT_LE(data + i * sizeof(gfloat), clamp_level(levels[i]));
  return gst_buffer_new_wrapped(data, n_levels * sizeof(gfloat));
}

/**
 * gst_tactile_map_buffer_get_levels:
 * @buffer: a buffer of a tactile stream
 * @rows: rows of the grid, from the stream's caps, 1 to %GST_TACTILE_MAX_SIDE
 * @columns: columns of the grid, from the stream's caps, 1 to
 *     %GST_TACTILE_MAX_SIDE
 * @levels: (out) (array length=n_levels) (transfer full): all levels in [0, 1],
 *     row-major, the top left tactor first. Values outside the range are clamped,
 *     NaN becomes 0. Free with g_free()
 * @n_levels: (out): number of @levels: @rows × @columns
 *
 * Copies the levels of a buffer of a tactile stream.
 *
 * Returns: %TRUE if @buffer is readable and holds exactly @rows × @columns
 *     levels; otherwise @levels is %NULL and @n_levels is 0
 *
 * Since: 0.1
 */
gboolean
gst_tactile_map_buffer_get_levels(GstBuffer *buffer, guint rows, guint columns, gfloat **levels,
                                  gsize *n_levels)
{
  GstMapInfo map;
  gsize n;

  g_return_val_if_fail(levels != NULL && n_levels != NULL, FALSE);
  *levels = NULL;
  *n_levels = 0;
  g_return_val_if_fail(GST_IS_BUFFER(buffer), FALSE);
  g_return_val_if_fail(rows >= 1 && rows <= GST_TACTILE_MAX_SIDE, FALSE);
  g_return_val_if_fail(columns >= 1 && columns <= GST_TACTILE_MAX_SIDE, FALSE);

  n = (gsize)rows * columns;
  if (!gst_buffer_map(buffer, &map, GST_MAP_READ))
    return FALSE;
  if (map.size == n * sizeof(gfloat)) {
    *levels = g_new(gfloat, n);
    *n_levels = n;
    /* Copy first: the payload may be unaligned, and GST_READ_FLOAT_LE requires alignment. */
    memcpy(*levels, map.data, map.size);
    for (gsize i = 0; i < n; i++)
      (*levels)[i] = clamp_level(GFLOAT_FROM_LE((*levels)[i]));
  }
  gst_buffer_unmap(buffer, &map);
  return *levels != NULL;
}
