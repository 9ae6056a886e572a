// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-tactileoverlay
 * @title: tactileoverlay
 * @short_description: draws tactile maps, or their saliency maps, over the picture
 *
 * tactileoverlay draws the #GstTactileMeta of each frame over the picture:
 *
 * - `style=grid`: the grid. A cell turns from yellow to red as its level rises, and a gauge on its
 *   left shows the level. A thick blue border marks a cell to which the [sound](../guide/sound.md)
 *   added.
 * - `style=heatmap`: a color map, from blue to red, of the frame's #GstSaliencyMeta, or of its
 *   levels if it has none.
 * - `style=saliency`: the saliency map in gray instead of the picture, white at the peak of the
 *   map or at twice its floor, whichever is higher. This needs `saliencytactile
 *   attach-saliency=true`; otherwise the element draws the levels and posts a warning.
 *
 * With `meter=true`, a bar along the lower edge shows the strongest event of the frame. Events
 * beyond the red mark, the floor, are felt; the width is four times the floor. The bar also needs
 * a #GstSaliencyMeta.
 *
 * Frames without metas do not change. If the video sink rotates the picture, as for films of
 * phones, the grid is upright on the screen; set `video-direction` as at the sink.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile ! tactileoverlay ! \
 *     videoconvert ! autovideosink
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile attach-saliency=true ! \
 *     tactileoverlay style=heatmap opacity=0.7 ! videoconvert ! autovideosink
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile attach-saliency=true ! \
 *     tactileoverlay style=saliency ! videoconvert ! autovideosink
 * ]|
 *
 * Since: 0.1
 */
#include "gsttactileoverlay.h"

#include "../properties.h"
#include "gst/fusion/sound_meta.h"
#include "gst/video/video_direction.h"
#include "gsttactileelements.h"
#include "overlaypainter.h"

#include <gst/tactile/tactile.h>

#include <algorithm>
#include <optional>

GST_DEBUG_CATEGORY_STATIC(tactile_overlay_debug);
#define GST_CAT_DEFAULT tactile_overlay_debug

namespace {

enum Style
{
  STYLE_GRID,
  STYLE_HEATMAP,
  STYLE_SALIENCY,
};

struct OverlaySettings
{
  Style style = STYLE_GRID;
  double opacity = 0.5;
  bool meter = false;
  GstVideoOrientationMethod video_direction = GST_VIDEO_ORIENTATION_AUTO;
};

struct Private
{
  OverlaySettings settings;     ///< object lock
  OverlayPainter painter;       ///< streaming thread
  OrientationTags tags;         ///< streaming thread
  tactile::TactileMap shown;    ///< streaming thread: the frame's map, as on the screen
  tactile::TactileMap stored;   ///< streaming thread: and in the frame's pixels
  tactile::TactileMap of_sound; ///< streaming thread: what of `stored` the sound added, or empty
  bool warned = false;          ///< streaming thread
};

#define OVERLAY_FORMATS                                                                            \
  "{ I420, YV12, NV12, NV21, YUY2, UYVY, Y42B, Y444, RGB, BGR, RGBx, BGRx, xRGB, xBGR, RGBA, "     \
  "BGRA, ARGB, ABGR, GRAY8, "                                                                      \
  "I420_10LE, P010_10LE }"

GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE(
    "sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(GST_VIDEO_CAPS_MAKE(OVERLAY_FORMATS)));
GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE(
    "src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(GST_VIDEO_CAPS_MAKE(OVERLAY_FORMATS)));

} // namespace

struct _GstTactileOverlay
{
  GstVideoFilter parent;
  Private *priv;
};

#define gst_tactile_overlay_parent_class parent_class
G_DEFINE_TYPE_WITH_CODE(GstTactileOverlay, gst_tactile_overlay, GST_TYPE_VIDEO_FILTER,
                        GST_DEBUG_CATEGORY_INIT(tactile_overlay_debug, "tactileoverlay", 0,
                                                "tactile maps drawn into the picture"));
GST_ELEMENT_REGISTER_DEFINE(tactileoverlay, "tactileoverlay", GST_RANK_NONE,
                            GST_TYPE_TACTILE_OVERLAY);

static GType
style_type(void)
{
  static const GEnumValue values[] = {
    { STYLE_GRID, "Grid of tactors with their levels", "grid" },
    { STYLE_HEATMAP, "Color map of the saliency, or of the levels", "heatmap" },
    { STYLE_SALIENCY, "Saliency map in gray instead of the picture", "saliency" },
    { 0, nullptr, nullptr },
  };
  static const GType type = properties::register_enum("GstTactileOverlayStyle", values);
  return type;
}

/// The levels as they are on the screen when the picture is turned like this.
static std::optional<LevelField>
tactile_field(GstBuffer *buffer, Private *priv, tactile::Orientation orientation)
{
  const GstTactileMeta *meta = gst_buffer_get_tactile_meta(buffer);
  if (meta == nullptr)
    return std::nullopt;
  gsize count = 0;
  const gfloat *levels = gst_tactile_meta_get_levels(meta, &count);
  priv->shown.rows = static_cast<int>(meta->rows);
  priv->shown.columns = static_cast<int>(meta->columns);
  priv->shown.levels.assign(levels, levels + count);
  tactile::turn_back(priv->shown, orientation, priv->stored);
  priv->of_sound.levels.clear();
  if (const auto added = sound_meta(buffer, meta->rows, meta->columns))
    tactile::turn_back(*added, orientation, priv->of_sound);
  return LevelField{ priv->stored.levels, priv->stored.columns, priv->stored.rows, 1.0,
                     priv->of_sound.levels };
}

static std::optional<LevelField>
saliency_field(GstBuffer *buffer)
{
  const GstSaliencyMeta *meta = gst_buffer_get_saliency_meta(buffer);
  if (meta == nullptr)
    return std::nullopt;
  gsize count = 0;
  const gfloat *values = gst_saliency_meta_get_values(meta, &count);
  const double peak = *std::max_element(values, values + count);
  const double white = std::max(peak, 2.0 * meta->floor); // a map at its floor is at most mid-gray
  return LevelField{ { values, count },
                     static_cast<int>(meta->width),
                     static_cast<int>(meta->height),
                     white > 0 ? 1 / white : 0 };
}

static void
gst_tactile_overlay_paint(GstTactileOverlay *self, const OverlaySettings &settings,
                          GstVideoFrame *frame)
{
  Private *priv = self->priv;
  const std::optional<LevelField> levels
      = tactile_field(frame->buffer, priv, orientation_of(settings.video_direction, priv->tags));
  const std::optional<LevelField> saliency
      = settings.style == STYLE_GRID ? std::nullopt : saliency_field(frame->buffer);
  const std::optional<LevelField> &shown = saliency ? saliency : levels;
  if (!shown)
    return;

  switch (settings.style) {
  case STYLE_GRID:
    priv->painter.paint_grid(frame, *shown, settings.opacity);
    break;
  case STYLE_HEATMAP:
    priv->painter.paint_heatmap(frame, *shown, settings.opacity);
    break;
  case STYLE_SALIENCY:
    if (!saliency && !priv->warned) {
      priv->warned = true;
      GST_ELEMENT_WARNING(self, STREAM, WRONG_TYPE,
                          ("style=saliency needs frames with a saliency map: set "
                           "attach-saliency=true on saliencytactile. "
                           "Showing the tactile levels."),
                          ("a frame has a GstTactileMeta, but no GstSaliencyMeta"));
    }
    priv->painter.paint_gray(frame, *shown);
    break;
  }
}

static void
gst_tactile_overlay_paint_meter(GstTactileOverlay *self, double opacity, GstVideoFrame *frame)
{
  constexpr double kFull = 4; // floors
  const GstSaliencyMeta *meta = gst_buffer_get_saliency_meta(frame->buffer);
  if (meta == nullptr || meta->floor <= 0)
    return;
  gsize count = 0;
  const gfloat *values = gst_saliency_meta_get_values(meta, &count);
  const double peak = *std::max_element(values, values + count);
  self->priv->painter.paint_meter(frame, peak / (kFull * meta->floor), 1 / kFull, opacity);
}

static GstFlowReturn
gst_tactile_overlay_transform_frame_ip(GstVideoFilter *filter, GstVideoFrame *frame)
{
  auto *self = GST_TACTILE_OVERLAY(filter);

  GST_OBJECT_LOCK(self);
  const OverlaySettings settings = self->priv->settings;
  GST_OBJECT_UNLOCK(self);
  gst_tactile_overlay_paint(self, settings, frame);
  if (settings.meter)
    gst_tactile_overlay_paint_meter(self, settings.opacity, frame);
  return GST_FLOW_OK;
}

static gboolean
gst_tactile_overlay_sink_event(GstBaseTransform *transform, GstEvent *event)
{
  GST_TACTILE_OVERLAY(transform)->priv->tags.follow(event);
  return GST_BASE_TRANSFORM_CLASS(parent_class)->sink_event(transform, event);
}

static void
gst_tactile_overlay_before_transform(GstBaseTransform *transform, GstBuffer *buffer)
{
  properties::sync_values(transform, transform->segment, GST_BUFFER_PTS(buffer));
}

static gboolean
gst_tactile_overlay_start(GstBaseTransform *transform)
{
  Private *priv = GST_TACTILE_OVERLAY(transform)->priv;
  priv->warned = false;
  priv->tags.reset();
  return TRUE;
}

using P = properties::Property<OverlaySettings>;
static constexpr P kProperties[] = {
  P::choice("style", "Kind of overlay", properties::kControllable, PROPERTY_FIELD(style),
            style_type),
  P::number<gdouble>("opacity", "Opacity of a full level in the styles grid and heatmap",
                     properties::kControllable, PROPERTY_FIELD(opacity), P::Range{ 0, 1 }),
  P::flag("meter", "Draw a bar with the frame's strongest event and a mark at the floor",
          properties::kControllable, PROPERTY_FIELD(meter)),
  P::choice("video-direction",
            "Rotation and flipping of the picture between this element and the screen, on which "
            "the grid is "
            "upright (auto: by the orientation tag)",
            properties::kPlaying, PROPERTY_FIELD(video_direction),
            gst_video_orientation_method_get_type),
};

static OverlaySettings &
gst_tactile_overlay_settings(GObject *object)
{
  return GST_TACTILE_OVERLAY(object)->priv->settings;
}

static void
gst_tactile_overlay_finalize(GObject *object)
{
  delete GST_TACTILE_OVERLAY(object)->priv;
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

static void
gst_tactile_overlay_class_init(GstTactileOverlayClass *klass)
{
  auto *object_class = G_OBJECT_CLASS(klass);
  auto *element_class = GST_ELEMENT_CLASS(klass);
  auto *transform_class = GST_BASE_TRANSFORM_CLASS(klass);
  object_class->finalize = gst_tactile_overlay_finalize;
  properties::install<OverlaySettings>(object_class, kProperties, { gst_tactile_overlay_settings });

  transform_class->start = GST_DEBUG_FUNCPTR(gst_tactile_overlay_start);
  transform_class->sink_event = GST_DEBUG_FUNCPTR(gst_tactile_overlay_sink_event);
  transform_class->before_transform = GST_DEBUG_FUNCPTR(gst_tactile_overlay_before_transform);
  GST_VIDEO_FILTER_CLASS(klass)->transform_frame_ip
      = GST_DEBUG_FUNCPTR(gst_tactile_overlay_transform_frame_ip);

  gst_element_class_add_static_pad_template(element_class, &sink_template);
  gst_element_class_add_static_pad_template(element_class, &src_template);
  gst_element_class_set_static_metadata(
      element_class, "Tactile map overlay", "Filter/Effect/Video",
      "Draws tactile maps, or their saliency maps, over the picture", "The visuotactile authors");
}

static void
gst_tactile_overlay_init(GstTactileOverlay *self)
{
  self->priv = new Private;
}
