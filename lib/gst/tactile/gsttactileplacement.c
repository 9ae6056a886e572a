/* SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gsttactileplacement.h"

#include <gst/video/gstvideometa.h>
#include <math.h>

/* GstVideoMetaTransformMatrix, which headers have from 1.28 on: a program that was built with older
 * ones may run on newer libraries. */
typedef struct
{
  const GstVideoInfo *in_info;
  GstVideoRectangle in_rectangle;
  const GstVideoInfo *out_info;
  GstVideoRectangle out_rectangle;
  gfloat matrix[3][3];
} MatrixTransform;
#if GST_CHECK_VERSION(1, 28, 0)
G_STATIC_ASSERT(sizeof(MatrixTransform) == sizeof(GstVideoMetaTransformMatrix));
#endif

#define TINY 1e-6

static gboolean
is_zero(gdouble value)
{
  return fabs(value) < TINY;
}

/* First b, then a. */
static GstTactileAffine
after(const GstTactileAffine *a, const GstTactileAffine *b)
{
  GstTactileAffine both;
  both.xx = a->xx * b->xx + a->xy * b->yx;
  both.xy = a->xx * b->xy + a->xy * b->yy;
  both.x0 = a->xx * b->x0 + a->xy * b->y0 + a->x0;
  both.yx = a->yx * b->xx + a->yy * b->yx;
  both.yy = a->yx * b->xy + a->yy * b->yy;
  both.y0 = a->yx * b->x0 + a->yy * b->y0 + a->y0;
  return both;
}

static GstTactileAffine
inverse(const GstTactileAffine *a)
{
  const gdouble det = a->xx * a->yy - a->xy * a->yx;
  GstTactileAffine back;
  back.xx = a->yy / det;
  back.xy = -a->xy / det;
  back.yx = -a->yx / det;
  back.yy = a->xx / det;
  back.x0 = -(back.xx * a->x0 + back.xy * a->y0);
  back.y0 = -(back.yx * a->x0 + back.yy * a->y0);
  return back;
}

static gboolean
equal(const GstTactileAffine *a, const GstTactileAffine *b)
{
  return is_zero(a->xx - b->xx) && is_zero(a->xy - b->xy) && is_zero(a->x0 - b->x0)
         && is_zero(a->yx - b->yx) && is_zero(a->yy - b->yy) && is_zero(a->y0 - b->y0);
}

/* Of the rectangle with these corners; they may be swapped. */
static void
map_rectangle(const GstTactileAffine *a, gdouble *left, gdouble *top, gdouble *right,
              gdouble *bottom)
{
  const gdouble x1 = a->xx * *left + a->xy * *top + a->x0;
  const gdouble x2 = a->xx * *right + a->xy * *bottom + a->x0;
  const gdouble y1 = a->yx * *left + a->yy * *top + a->y0;
  const gdouble y2 = a->yx * *right + a->yy * *bottom + a->y0;
  *left = MIN(x1, x2);
  *right = MAX(x1, x2);
  *top = MIN(y1, y2);
  *bottom = MAX(y1, y2);
}

/* From the stored picture to the screen. */
static GstTactileAffine
turn(GstVideoOrientationMethod direction)
{
  switch (direction) {
  case GST_VIDEO_ORIENTATION_90R:
    return (GstTactileAffine){ 0, -1, 1, 1, 0, 0 };
  case GST_VIDEO_ORIENTATION_180:
    return (GstTactileAffine){ -1, 0, 1, 0, -1, 1 };
  case GST_VIDEO_ORIENTATION_90L:
    return (GstTactileAffine){ 0, 1, 0, -1, 0, 1 };
  case GST_VIDEO_ORIENTATION_HORIZ:
    return (GstTactileAffine){ -1, 0, 1, 0, 1, 0 };
  case GST_VIDEO_ORIENTATION_VERT:
    return (GstTactileAffine){ 1, 0, 0, 0, -1, 1 };
  case GST_VIDEO_ORIENTATION_UL_LR:
    return (GstTactileAffine){ 0, 1, 0, 1, 0, 0 };
  case GST_VIDEO_ORIENTATION_UR_LL:
    return (GstTactileAffine){ 0, -1, 1, -1, 0, 1 };
  default:
    return (GstTactileAffine){ 1, 0, 0, 0, 1, 0 };
  }
}

/* The matrix is of the pixels' upper left corners: where it mirrors, the pixel's other corner is
 * the upper left one. FALSE if sides do not stay parallel. */
static gboolean
read_matrix(const MatrixTransform *transform, GstTactileAffine *affine)
{
  const gfloat(*m)[3] = transform->matrix;
  const gboolean straight = is_zero(m[0][1]) && is_zero(m[1][0]);
  const gboolean transposed = is_zero(m[0][0]) && is_zero(m[1][1]);
  if (straight == transposed || !is_zero(m[2][0]) || !is_zero(m[2][1]) || !is_zero(m[2][2] - 1))
    return FALSE;
  for (guint row = 0; row < 2; row++)
    for (guint column = 0; column < 3; column++)
      if (!isfinite(m[row][column]))
        return FALSE;
  const gdouble a = straight ? m[0][0] : m[0][1];
  const gdouble b = straight ? m[1][1] : m[1][0];
  if (is_zero(a) || is_zero(b))
    return FALSE;
  const GstTactileAffine pixels
      = { .xx = m[0][0],
          .xy = m[0][1],
          .x0 = m[0][2] + MAX(-a, 0) + transform->out_rectangle.x
                - m[0][0] * transform->in_rectangle.x - m[0][1] * transform->in_rectangle.y,
          .yx = m[1][0],
          .yy = m[1][1],
          .y0 = m[1][2] + MAX(-b, 0) + transform->out_rectangle.y
                - m[1][0] * transform->in_rectangle.x - m[1][1] * transform->in_rectangle.y };
  const GstTactileAffine grow = { .xx = GST_VIDEO_INFO_WIDTH(transform->in_info),
                                  .yy = GST_VIDEO_INFO_HEIGHT(transform->in_info) };
  const GstTactileAffine shrink = { .xx = 1.0 / GST_VIDEO_INFO_WIDTH(transform->out_info),
                                    .yy = 1.0 / GST_VIDEO_INFO_HEIGHT(transform->out_info) };
  const GstTactileAffine grown = after(&pixels, &grow);
  *affine = after(&shrink, &grown);
  return TRUE;
}

gboolean
gst_tactile_placement_init(GstTactilePlacement *self, GQuark type, gconstpointer data,
                           GstVideoOrientationMethod direction)
{
  const MatrixTransform *transform = (const MatrixTransform *)data;
  GstTactileAffine matrix;
  if (type != g_quark_from_static_string("gst-video-matrix") || transform == NULL
      || transform->in_info == NULL || transform->out_info == NULL
      || GST_VIDEO_INFO_WIDTH(transform->in_info) <= 0
      || GST_VIDEO_INFO_HEIGHT(transform->in_info) <= 0
      || GST_VIDEO_INFO_WIDTH(transform->out_info) <= 0
      || GST_VIDEO_INFO_HEIGHT(transform->out_info) <= 0 || !read_matrix(transform, &matrix))
    return FALSE;

  const GstTactileAffine shown = turn(direction);
  const GstTactileAffine unturned = turn(GST_VIDEO_ORIENTATION_IDENTITY);
  self->turns_by = !equal(&shown, &unturned) && equal(&matrix, &shown);
  const GstTactileAffine stored = inverse(&shown);
  const GstTactileAffine turned = after(&matrix, &stored);
  self->forth = self->turns_by ? unturned : after(&shown, &turned);

  const gdouble width = GST_VIDEO_INFO_WIDTH(transform->out_info);
  const gdouble height = GST_VIDEO_INFO_HEIGHT(transform->out_info);
  const GstVideoRectangle *box = &transform->out_rectangle;
  self->left = box->x / width;
  self->top = box->y / height;
  self->right = (box->x + (gdouble)box->w) / width;
  self->bottom = (box->y + (gdouble)box->h) / height;
  if (self->turns_by) {
    self->left = self->top = 0;
    self->right = self->bottom = 1;
  } else {
    map_rectangle(&shown, &self->left, &self->top, &self->right, &self->bottom);
  }
  return TRUE;
}

gboolean
gst_tactile_placement_is_transposed(const GstTactilePlacement *self)
{
  return is_zero(self->forth.xx);
}

/* The mean of what cells have of a rectangle of the picture; it ends with the picture. */
static gfloat
mean(guint rows, guint columns, const gfloat *values, gdouble left, gdouble top, gdouble right,
     gdouble bottom)
{
  left = CLAMP(left, 0, 1) * columns;
  right = CLAMP(right, 0, 1) * columns;
  top = CLAMP(top, 0, 1) * rows;
  bottom = CLAMP(bottom, 0, 1) * rows;
  gdouble sum = 0;
  gdouble area = 0;
  for (guint row = (guint)top; row < rows && row < bottom; row++)
    for (guint column = (guint)left; column < columns && column < right; column++) {
      const gdouble high = MIN(bottom, row + 1.0) - MAX(top, row);
      const gdouble wide = MIN(right, column + 1.0) - MAX(left, column);
      if (high <= TINY || wide <= TINY)
        continue;
      sum += high * wide * values[(gsize)row * columns + column];
      area += high * wide;
    }
  return area > 0 ? (gfloat)(sum / area) : 0;
}

void
gst_tactile_placement_apply(const GstTactilePlacement *self, guint rows, guint columns,
                            const gfloat *values, guint out_rows, guint out_columns, gfloat *out)
{
  const GstTactileAffine back = inverse(&self->forth);
  for (guint row = 0; row < out_rows; row++)
    for (guint column = 0; column < out_columns; column++) {
      gdouble left = MAX((gdouble)column / out_columns, self->left);
      gdouble right = MIN((column + 1.0) / out_columns, self->right);
      gdouble top = MAX((gdouble)row / out_rows, self->top);
      gdouble bottom = MIN((row + 1.0) / out_rows, self->bottom);
      gfloat *cell = &out[(gsize)row * out_columns + column];
      if (left >= right || top >= bottom) {
        *cell = 0;
        continue;
      }
      map_rectangle(&back, &left, &top, &right, &bottom);
      *cell = mean(rows, columns, values, left, top, right, bottom);
    }
}
