// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "support/unmappable.h"

#include <gst/base/gstbasetransform.h>
#include <gst/video/video.h>

/// Stands for vapostproc, which needs a GPU: scales memory that only it can read (Unmappable), into
/// such memory or into the system's.
class FakeVaPostProc
{
public:
  /// The context that it asks its neighbors for.
  static constexpr const char *kContext = "gst.va.display.handle";

  /// Registers it under that name, before others.
  static void install()
  {
    fail_unless(gst_element_register(nullptr, "vapostproc", GST_RANK_NONE, type()));
  }

  /// How many there are.
  static int alive()
  {
    return g_atomic_int_get(&count());
  }

private:
  static int &count()
  {
    static int alive = 0;
    return alive;
  }
  struct Element
  {
    GstBaseTransform parent;
    GstVideoInfo in;
    GstVideoInfo out;
    GstVideoConverter *converter;
    gboolean hides;
  };

  static GType type()
  {
    static const GType type = g_type_register_static_simple(
        GST_TYPE_BASE_TRANSFORM, "FakeVaPostProc", sizeof(GstBaseTransformClass), init_class,
        sizeof(Element), [](GTypeInstance *, gpointer) { g_atomic_int_inc(&count()); },
        GTypeFlags{});
    return type;
  }
  static void init_class(gpointer klass, gpointer)
  {
    auto *element = GST_ELEMENT_CLASS(klass);
    auto *transform = GST_BASE_TRANSFORM_CLASS(klass);
    static gpointer parent = g_type_class_peek_parent(klass);
    G_OBJECT_CLASS(klass)->finalize = [](GObject *object) {
      g_atomic_int_add(&count(), -1);
      G_OBJECT_CLASS(parent)->finalize(object);
    };
    gst_element_class_set_static_metadata(element, "Fake", "Filter/Video", "For tests", "Tests");
    add_pad(element, "sink", GST_PAD_SINK,
            "video/x-raw(memory:VAMemory); video/x-raw(memory:DMABuf)");
    add_pad(element, "src", GST_PAD_SRC, kOutput);
    transform->transform_caps = [](GstBaseTransform *, GstPadDirection direction, GstCaps *,
                                   GstCaps *filter) {
      GstCaps *caps = gst_caps_from_string(
          direction == GST_PAD_SINK ? kOutput
                                    : "video/x-raw(memory:VAMemory); video/x-raw(memory:DMABuf)");
      if (filter)
        gst_caps_take(&caps, gst_caps_intersect_full(filter, caps, GST_CAPS_INTERSECT_FIRST));
      return caps;
    };
    transform->fixate_caps
        = [](GstBaseTransform *, GstPadDirection, GstCaps *caps, GstCaps *other) {
            other = gst_caps_make_writable(gst_caps_truncate(other));
            GstStructure *to = gst_caps_get_structure(other, 0);
            for (const char *field : { "format", "framerate", "width", "height" })
              if (!gst_structure_has_field(to, field))
                gst_structure_set_value(
                    to, field, gst_structure_get_value(gst_caps_get_structure(caps, 0), field));
            return gst_caps_fixate(other);
          };
    transform->set_caps = [](GstBaseTransform *base, GstCaps *in, GstCaps *out) -> gboolean {
      auto *self = reinterpret_cast<Element *>(base);
      if (!gst_video_info_from_caps(&self->in, in) || !gst_video_info_from_caps(&self->out, out))
        return FALSE;
      self->hides = gst_caps_features_contains(gst_caps_get_features(out, 0), "memory:VAMemory");
      self->converter = gst_video_converter_new(&self->in, &self->out, nullptr);
      return self->converter != nullptr;
    };
    transform->start = [](GstBaseTransform *base) -> gboolean {
      g_autoptr(GstQuery) query = gst_query_new_context(kContext);
      gst_pad_peer_query(base->sinkpad, query);
      gst_element_post_message(GST_ELEMENT(base),
                               gst_message_new_need_context(GST_OBJECT(base), kContext));
      return TRUE;
    };
    transform->stop = [](GstBaseTransform *base) -> gboolean {
      g_clear_pointer(&reinterpret_cast<Element *>(base)->converter, gst_video_converter_free);
      return TRUE;
    };
    transform->prepare_output_buffer = [](GstBaseTransform *base, GstBuffer *, GstBuffer **out) {
      const auto *self = reinterpret_cast<Element *>(base);
      *out = gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&self->out), nullptr);
      return GST_FLOW_OK;
    };
    transform->transform = [](GstBaseTransform *base, GstBuffer *in, GstBuffer *out) {
      auto *self = reinterpret_cast<Element *>(base);
      g_autoptr(GstBuffer) shown = Unmappable::show(gst_buffer_ref(in));
      GstVideoFrame from;
      GstVideoFrame to;
      fail_unless(gst_video_frame_map(&from, &self->in, shown, GST_MAP_READ));
      fail_unless(gst_video_frame_map(&to, &self->out, out, GST_MAP_WRITE));
      gst_video_converter_frame(self->converter, &from, &to);
      gst_video_frame_unmap(&to);
      gst_video_frame_unmap(&from);
      if (self->hides)
        gst_buffer_replace_all_memory(out, Unmappable::hide(gst_buffer_get_all_memory(out)));
      return GST_FLOW_OK;
    };
  }
  static void add_pad(GstElementClass *klass, const char *name, GstPadDirection direction,
                      const char *caps)
  {
    g_autoptr(GstCaps) parsed = gst_caps_from_string(caps);
    gst_element_class_add_pad_template(
        klass, gst_pad_template_new(name, direction, GST_PAD_ALWAYS, parsed));
  }

  static constexpr const char *kOutput
      = "video/x-raw(memory:VAMemory); video/x-raw,format={ I420, NV12 }";
};
