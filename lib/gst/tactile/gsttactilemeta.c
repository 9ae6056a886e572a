/* SPDX-License-Identifier: LGPL-2.1-or-later */

/**
 * SECTION:gsttactilemeta
 * @title: GstTactileMeta
 * @short_description: levels of a grid of tactors on a video frame
 *
 * `saliencytactile` adds a #GstTactileMeta to every frame that it analyzes;
 * `tactorsink`, `tactileextractor` and `tactileoverlay` read it. An application
 * can add its own with gst_buffer_add_tactile_meta().
 */

#include "gsttactilemeta.h"

#include "gsttactileplacement.h"

#include <gst/video/gstvideometa.h>

typedef struct
{
  GstTactileMeta parent;
  GstVideoOrientationMethod direction;
  gfloat frequency; /* Hz; 0: none */
} TactileMeta;

static gboolean
gst_tactile_meta_init(GstMeta *meta, gpointer params, GstBuffer *buffer)
{
  GstTactileMeta *self = (GstTactileMeta *)meta;

  self->rows = 0;
  self->columns = 0;
  self->levels = NULL;
  ((TactileMeta *)meta)->direction = GST_VIDEO_ORIENTATION_IDENTITY;
  ((TactileMeta *)meta)->frequency = 0;
  return TRUE;
}

static void
gst_tactile_meta_free(GstMeta *meta, GstBuffer *buffer)
{
  GstTactileMeta *self = (GstTactileMeta *)meta;

  g_clear_pointer(&self->levels, g_free);
}

/* Several pictures of one frame, as of compositor, have one map: each cell's stronger level, the
 * frequency of the last one that has any. */
static GstTactileMeta *
gst_tactile_meta_place(GstBuffer *dest, const GstTactileMeta *self,
                       const GstTactilePlacement *placement)
{
  const GstTactileMeta *there = gst_buffer_get_tactile_meta(dest);
  const guint rows = there ? there->rows : self->rows;
  const guint columns = there ? there->columns : self->columns;
  const gsize n_levels = (gsize)rows * columns;
  const gfloat own = ((const TactileMeta *)self)->frequency;
  const gfloat frequency = own == 0 && there ? ((const TactileMeta *)there)->frequency : own;
  gfloat *levels = g_new(gfloat, n_levels);
  GstTactileMeta *placed;

  gst_tactile_placement_apply(placement, self->rows, self->columns, self->levels, rows, columns,
                              levels);
  for (gsize i = 0; there != NULL && i < n_levels; i++)
    levels[i] = MAX(levels[i], there->levels[i]);
  placed = gst_buffer_add_tactile_meta(dest, rows, columns, levels, n_levels);
  if (placed != NULL)
    ((TactileMeta *)placed)->frequency = frequency;
  g_free(levels);
  return placed;
}

static gboolean
gst_tactile_meta_transform(GstBuffer *dest, GstMeta *meta, GstBuffer *buffer, GQuark type,
                           gpointer data)
{
  const GstTactileMeta *self = (const GstTactileMeta *)meta;
  GstVideoOrientationMethod direction = ((const TactileMeta *)meta)->direction;
  GstTactilePlacement placement;
  GstTactileMeta *other = NULL;

  if (self->levels == NULL) /* as after gst_buffer_add_meta() */
    return FALSE;
  /* Levels are relative to the picture, so a scaled picture keeps them. A copy of a region copies a
   * range of bytes, not a part of the picture, so it keeps the whole grid. */
  if (GST_META_TRANSFORM_IS_COPY(type) || GST_VIDEO_META_TRANSFORM_IS_SCALE(type)) {
    other = gst_buffer_add_tactile_meta(dest, self->rows, self->columns, self->levels,
                                        (gsize)self->rows * self->columns);
    if (other != NULL)
      ((TactileMeta *)other)->frequency = ((const TactileMeta *)meta)->frequency;
  } else if (gst_tactile_placement_init(&placement, type, data, direction)) {
    if (placement.turns_by)
      direction = GST_VIDEO_ORIENTATION_IDENTITY;
    other = gst_tactile_meta_place(dest, self, &placement);
  }
  if (other == NULL)
    return FALSE;
  gst_tactile_meta_set_video_direction(other, direction);
  return TRUE;
}

/* lib/gst/fusion/later_maps.cpp: they follow the frame's own map, until that is replaced. */
#define LATER_MAPS_META "VisuotactileLaterMaps"

/* The frequency of a buffer of a stream of maps, which has no GstTactileMeta. */
#define FREQUENCY_META "GstTactileFrequencyMeta"

static void
register_frequency_meta(void)
{
  static gsize is_registered = 0;
  static const gchar *tags[] = { NULL };

  if (g_once_init_enter(&is_registered)) {
    gst_meta_register_custom(FREQUENCY_META, tags, NULL, NULL, NULL);
    g_once_init_leave(&is_registered, 1);
  }
}

#if GST_CHECK_VERSION(1, 24, 0)
/* For unixfdsink and others that pass buffers to other processes: rows, columns, direction,
 * frequency, levels, 4 bytes each, little-endian. */
enum
{
  HEADER = 16
};

static gboolean
gst_tactile_meta_serialize(const GstMeta *meta, GstByteArrayInterface *data, guint8 *version)
{
  const GstTactileMeta *self = (const GstTactileMeta *)meta;
  const gsize n_levels = (gsize)self->rows * self->columns;
  guint8 *bytes
      = n_levels > 0 ? gst_byte_array_interface_append(data, HEADER + n_levels * 4) : NULL;

  if (bytes == NULL)
    return FALSE;
  *version = 2;
  GST_WRITE_UINT32_LE(bytes, self->rows);
  GST_WRITE_UINT32_LE(bytes + 4, self->columns);
  GST_WRITE_UINT32_LE(bytes + 8, ((const TactileMeta *)meta)->direction);
  GST_WRITE_FLOAT_LE(bytes + 12, ((const TactileMeta *)meta)->frequency);
  for (gsize i = 0; i < n_levels; i++)
    GST_WRITE_FLOAT_LE(bytes + HEADER + i * 4, self->levels[i]);
  return TRUE;
}

static GstMeta *
gst_tactile_meta_deserialize(const GstMetaInfo *info, GstBuffer *buffer, const guint8 *data,
                             gsize size, guint8 version)
{
  const guint32 rows = size >= HEADER ? GST_READ_UINT32_LE(data) : 0;
  const guint32 columns = size >= HEADER ? GST_READ_UINT32_LE(data + 4) : 0;
  const guint32 direction = size >= HEADER ? GST_READ_UINT32_LE(data + 8) : 0;
  const gfloat frequency = size >= HEADER ? GST_READ_FLOAT_LE(data + 12) : 0;
  gfloat levels[GST_TACTILE_MAX_SIDE * GST_TACTILE_MAX_SIDE];
  GstTactileMeta *self;

  if (version != 2 || rows < 1 || rows > GST_TACTILE_MAX_SIDE || columns < 1
      || columns > GST_TACTILE_MAX_SIDE || size != HEADER + (gsize)rows * columns * 4
      || direction > GST_VIDEO_ORIENTATION_CUSTOM)
    return NULL;
  for (gsize i = 0; i < (gsize)rows * columns; i++)
    levels[i] = GST_READ_FLOAT_LE(data + HEADER + i * 4);
  self = gst_buffer_add_tactile_meta(buffer, rows, columns, levels, (gsize)rows * columns);
  if (self != NULL) {
    gst_tactile_meta_set_video_direction(self, (GstVideoOrientationMethod)direction);
    ((TactileMeta *)self)->frequency = frequency >= 1 && frequency <= 1000 ? frequency : 0;
  }
  return (GstMeta *)self;
}
#endif

/**
 * gst_tactile_meta_api_get_type: (skip)
 *
 * Gets the #GType of the metadata API, for gst_buffer_get_meta() and
 * gst_buffer_iterate_meta_filtered().
 *
 * Returns: the type of the #GstTactileMeta API. Its tags are `video`, `size` and
 *     `orientation`, so that elements that move the picture drop the map, or
 *     tell where they put the picture
 *
 * Since: 0.1
 */
GType
gst_tactile_meta_api_get_type(void)
{
  static GType type = 0;
  static const gchar *tags[] = { GST_META_TAG_VIDEO_STR, GST_META_TAG_VIDEO_SIZE_STR,
                                 GST_META_TAG_VIDEO_ORIENTATION_STR, NULL };

  if (g_once_init_enter(&type)) {
    GType registered = gst_meta_api_type_register("GstTactileMetaAPI", tags);
    g_once_init_leave(&type, registered);
  }
  return type;
}

/**
 * gst_tactile_meta_get_info: (skip)
 *
 * Gets the #GstMetaInfo of the implementation, for gst_buffer_add_meta(). A
 * process that receives maps of another one, as by `unixfdsrc`, calls it, or
 * loads a plugin that does, before the first buffer arrives.
 *
 * Returns: the #GstMetaInfo of #GstTactileMeta
 *
 * Since: 0.1
 */
const GstMetaInfo *
gst_tactile_meta_get_info(void)
{
  static const GstMetaInfo *info = NULL;

  if (g_once_init_enter(&info)) {
#if GST_CHECK_VERSION(1, 24, 0)
    GstMetaInfo *own
        = gst_meta_info_new(GST_TACTILE_META_API_TYPE, "GstTactileMeta", sizeof(TactileMeta));
    own->init_func = gst_tactile_meta_init;
    own->free_func = gst_tactile_meta_free;
    own->transform_func = gst_tactile_meta_transform;
    own->serialize_func = gst_tactile_meta_serialize;
    own->deserialize_func = gst_tactile_meta_deserialize;
    const GstMetaInfo *registered = gst_meta_info_register(own);
#else
    const GstMetaInfo *registered = gst_meta_register(
        GST_TACTILE_META_API_TYPE, "GstTactileMeta", sizeof(TactileMeta), gst_tactile_meta_init,
        gst_tactile_meta_free, gst_tactile_meta_transform);
#endif
    register_frequency_meta();
    g_once_init_leave(&info, registered);
  }
  return info;
}

/**
 * gst_buffer_add_tactile_meta:
 * @buffer: a writable #GstBuffer
 * @rows: rows of the grid, 1 to %GST_TACTILE_MAX_SIDE
 * @columns: columns of the grid, 1 to %GST_TACTILE_MAX_SIDE
 * @levels: (array length=n_levels): levels in [0, 1], row-major, the top left
 *     tactor as seen on the screen first. They are copied; values outside the
 *     range are clamped, NaN becomes 0
 * @n_levels: number of @levels: @rows × @columns
 *
 * Attaches a tactile map to a video frame. A frame has one tactile map: if
 * @buffer already has a #GstTactileMeta, its grid and levels are replaced, so
 * that a frame that is analyzed twice is not felt twice. The new map has no
 * frequency.
 *
 * Returns: (transfer none) (nullable): the #GstTactileMeta on @buffer, or %NULL
 *     if a parameter is out of range
 *
 * Since: 0.1
 */
GstTactileMeta *
gst_buffer_add_tactile_meta(GstBuffer *buffer, guint rows, guint columns, const gfloat *levels,
                            gsize n_levels)
{
  GstTactileMeta *self;
  GstCustomMeta *later;
  gfloat *copy;

  g_return_val_if_fail(GST_IS_BUFFER(buffer), NULL);
  g_return_val_if_fail(gst_buffer_is_writable(buffer), NULL);
  g_return_val_if_fail(rows >= 1 && rows <= GST_TACTILE_MAX_SIDE, NULL);
  g_return_val_if_fail(columns >= 1 && columns <= GST_TACTILE_MAX_SIDE, NULL);
  g_return_val_if_fail(levels != NULL, NULL);
  g_return_val_if_fail(n_levels == (gsize)rows * columns, NULL);

  self = gst_buffer_get_tactile_meta(buffer);
  if (self == NULL)
    self = (GstTactileMeta *)gst_buffer_add_meta(buffer, GST_TACTILE_META_INFO, NULL);
  if (self == NULL)
    return NULL;

  /* @levels may belong to the meta that is replaced. */
  copy = g_new(gfloat, n_levels);
  for (gsize i = 0; i < n_levels; i++)
    copy[i] = levels[i] > 0 ? MIN(levels[i], 1.0f) : 0.0f; /* NaN > 0 is false */

  g_free(self->levels);
  self->levels = copy;
  if (gst_meta_get_info(LATER_MAPS_META) != NULL
      && (later = gst_buffer_get_custom_meta(buffer, LATER_MAPS_META)) != NULL)
    gst_structure_remove_all_fields(gst_custom_meta_get_structure(later));
  ((TactileMeta *)self)->frequency = 0;
  self->rows = rows;
  self->columns = columns;
  return self;
}

/**
 * gst_buffer_get_tactile_meta:
 * @buffer: a #GstBuffer
 *
 * Gets the tactile map of a video frame.
 *
 * Returns: (transfer none) (nullable): the #GstTactileMeta on @buffer, or %NULL
 *     if it has none
 *
 * Since: 0.1
 */
GstTactileMeta *
gst_buffer_get_tactile_meta(GstBuffer *buffer)
{
  g_return_val_if_fail(GST_IS_BUFFER(buffer), NULL);

  return (GstTactileMeta *)gst_buffer_get_meta(buffer, GST_TACTILE_META_API_TYPE);
}

/**
 * gst_tactile_meta_get_level:
 * @meta: a #GstTactileMeta
 * @row: row of the tactor, counted from the top; less than the grid's rows
 * @column: column of the tactor, counted from the left; less than the grid's
 *     columns
 *
 * Gets the level of one tactor.
 *
 * Returns: the tactor's level in [0, 1]
 *
 * Since: 0.1
 */
gfloat
gst_tactile_meta_get_level(const GstTactileMeta *meta, guint row, guint column)
{
  g_return_val_if_fail(meta != NULL, 0);
  g_return_val_if_fail(row < meta->rows && column < meta->columns, 0);

  return meta->levels[(gsize)row * meta->columns + column];
}

/**
 * gst_tactile_meta_get_levels:
 * @meta: a #GstTactileMeta
 * @n_levels: (out): number of levels: rows × columns
 *
 * Gets all levels of the map without copying them. The array is valid until the
 * meta is removed from its buffer or replaced.
 *
 * Returns: (array length=n_levels) (transfer none): all levels in [0, 1],
 *     row-major, the top left tactor as seen on the screen first
 *
 * Since: 0.1
 */
const gfloat *
gst_tactile_meta_get_levels(const GstTactileMeta *meta, gsize *n_levels)
{
  g_return_val_if_fail(meta != NULL, NULL);
  g_return_val_if_fail(n_levels != NULL, NULL);

  *n_levels = (gsize)meta->rows * meta->columns;
  return meta->levels;
}

/**
 * gst_buffer_set_tactile_frequency:
 * @buffer: a writable #GstBuffer with a tactile map, on a video frame or of a
 *     stream of maps
 * @frequency: in Hz, 1 to 1000; 0: none
 *
 * Sets the frequency of the vibrations of a map, for actuators that have a
 * choice, such as shakers at a sound card.
 *
 * Since: 0.2
 */
void
gst_buffer_set_tactile_frequency(GstBuffer *buffer, gfloat frequency)
{
  GstTactileMeta *map;
  GstCustomMeta *meta;

  g_return_if_fail(GST_IS_BUFFER(buffer));
  g_return_if_fail(gst_buffer_is_writable(buffer));
  g_return_if_fail(frequency == 0 || (frequency >= 1 && frequency <= 1000));

  map = gst_buffer_get_tactile_meta(buffer);
  if (map != NULL) {
    ((TactileMeta *)map)->frequency = frequency;
    return;
  }
  register_frequency_meta();
  meta = gst_buffer_get_custom_meta(buffer, FREQUENCY_META);
  if (frequency == 0) {
    if (meta != NULL)
      gst_buffer_remove_meta(buffer, &meta->meta);
    return;
  }
  if (meta == NULL)
    meta = gst_buffer_add_custom_meta(buffer, FREQUENCY_META);
  gst_structure_set(gst_custom_meta_get_structure(meta), "hz", G_TYPE_FLOAT, frequency, NULL);
}

/**
 * gst_buffer_get_tactile_frequency:
 * @buffer: a #GstBuffer
 *
 * Gets the frequency of the vibrations of a map.
 *
 * Returns: the frequency in Hz; 0: none
 *
 * Since: 0.2
 */
gfloat
gst_buffer_get_tactile_frequency(GstBuffer *buffer)
{
  const GstTactileMeta *map;
  GstCustomMeta *meta;
  gfloat frequency = 0;

  g_return_val_if_fail(GST_IS_BUFFER(buffer), 0);

  map = gst_buffer_get_tactile_meta(buffer);
  if (map != NULL)
    return ((const TactileMeta *)map)->frequency;
  register_frequency_meta();
  meta = gst_buffer_get_custom_meta(buffer, FREQUENCY_META);
  if (meta != NULL)
    gst_structure_get(gst_custom_meta_get_structure(meta), "hz", G_TYPE_FLOAT, &frequency, NULL);
  return frequency >= 1 && frequency <= 1000 ? frequency : 0;
}

/**
 * gst_tactile_meta_set_video_direction:
 * @meta: a #GstTactileMeta
 * @direction: how the frame is still to be turned to be as seen on the screen,
 *     such as its `image-orientation` tag says;
 *     %GST_VIDEO_ORIENTATION_IDENTITY, the default, if it is not
 *
 * Tells that the levels, which are as seen on the screen, are of a frame that
 * something downstream has yet to turn. Where that is done, the levels stay as
 * they are; without this, they would be turned with the frame.
 *
 * Since: 0.2
 */
void
gst_tactile_meta_set_video_direction(GstTactileMeta *meta, GstVideoOrientationMethod direction)
{
  g_return_if_fail(meta != NULL);

  ((TactileMeta *)meta)->direction = direction;
}
