/* SPDX-License-Identifier: LGPL-2.1-or-later */
#ifndef __GST_TACTILE_PLACEMENT_H__
#define __GST_TACTILE_PLACEMENT_H__

#include <gst/video/video.h>

/* An affine map of the unit square, x to the right, y down. */
typedef struct
{
  gdouble xx, xy, x0; /* x' = xx x + xy y + x0 */
  gdouble yx, yy, y0;
} GstTactileAffine;

/* Where an element puts a picture in its output. Not installed. */
typedef struct
{
  GstTactileAffine forth;
  gdouble left, top, right, bottom; /* of what is seen of the picture in the output */
  gboolean turns_by; /* the whole picture, by the direction that it was to be turned by */
} GstTactilePlacement;

/* Of the transform `gst-video-matrix` (GStreamer 1.28), as seen on a screen that turns both
 * pictures by `direction`. FALSE for other transforms, and where the sides of the picture do not
 * stay parallel to those of the screen. */
gboolean gst_tactile_placement_init(GstTactilePlacement *self, GQuark type, gconstpointer data,
                                    GstVideoOrientationMethod direction);

/* The picture's rows become columns. */
gboolean gst_tactile_placement_is_transposed(const GstTactilePlacement *self);

/* The mean of what each cell of the output shows of the picture; 0 where it shows nothing of it. */
void gst_tactile_placement_apply(const GstTactilePlacement *self, guint rows, guint columns,
                                 const gfloat *values, guint out_rows, guint out_columns,
                                 gfloat *out);

#endif /* __GST_TACTILE_PLACEMENT_H__ */
