// SPDX-License-Identifier: LGPL-2.1-or-later
#include "innerdecoder.h"

#include "decoderchoice.h"

#include <utility>

GST_DEBUG_CATEGORY_EXTERN(visuotactile_decoder_debug);
#define GST_CAT_DEFAULT visuotactile_decoder_debug

namespace {

/// Whether there is a decoder for the stream, which need not be put in.
bool
can_decode(GstCaps *caps)
{
  GstElement *decoder = choose_decoder(caps);
  if (decoder)
    gst_object_unref(gst_object_ref_sink(decoder));
  return decoder != nullptr;
}

} // namespace

InnerDecoder::InnerDecoder(GstBin *bin, GstPad *sink, GstElement *next)
    : bin_(bin), sink_(sink), next_(next)
{
}

InnerDecoder::~InnerDecoder()
{
  take_out();
}

bool
InnerDecoder::accept(GstCaps *caps, bool begins)
{
  const std::lock_guard lock(choosing_);
  g_autoptr(GstElement) decoder = ref();
  if (decoder) {
    g_autoptr(GstPad) sink = gst_element_get_static_pad(decoder, "sink");
    if (gst_pad_query_accept_caps(sink, caps))
      return true;
    if (gst_pad_has_current_caps(sink))
      return false;
    if (!begins)
      return can_decode(caps);
    take_out();
  }
  return add(caps);
}

GstCaps *
InnerDecoder::caps(GstCaps *filter)
{
  g_autoptr(GstElement) decoder = ref();
  if (decoder) {
    g_autoptr(GstPad) sink = gst_element_get_static_pad(decoder, "sink");
    if (gst_pad_has_current_caps(sink))
      return gst_pad_query_caps(sink, filter);
  }
  g_autoptr(GstCaps) own = gst_pad_get_pad_template_caps(sink_);
  g_autoptr(GstCaps) all = decodable_caps();
  GstCaps *caps = gst_caps_intersect_full(all, own, GST_CAPS_INTERSECT_FIRST);
  if (filter)
    gst_caps_take(&caps, gst_caps_intersect_full(filter, caps, GST_CAPS_INTERSECT_FIRST));
  return caps;
}

void
InnerDecoder::remove()
{
  const std::lock_guard lock(choosing_);
  take_out();
}

GstElement *
InnerDecoder::ref() const
{
  GST_OBJECT_LOCK(bin_);
  GstElement *decoder = decoder_ ? GST_ELEMENT(gst_object_ref(decoder_)) : nullptr;
  GST_OBJECT_UNLOCK(bin_);
  return decoder;
}

/// Puts the best decoder for the stream in. False if there is none.
bool
InnerDecoder::add(GstCaps *caps)
{
  GstElement *decoder = choose_decoder(caps);
  if (decoder == nullptr)
    return false;
  GST_INFO_OBJECT(bin_, "%" GST_PTR_FORMAT " decodes %" GST_PTR_FORMAT, decoder, caps);
  GST_OBJECT_LOCK(bin_);
  decoder_ = GST_ELEMENT(gst_object_ref(decoder));
  GST_OBJECT_UNLOCK(bin_);
  gst_bin_add(bin_, decoder);
  g_autoptr(GstPad) sink = gst_element_get_static_pad(decoder, "sink");
  const bool linked = gst_element_link_pads(decoder, "src", next_, "sink")
                      && gst_ghost_pad_set_target(GST_GHOST_PAD(sink_), sink)
                      && gst_element_sync_state_with_parent(decoder);
  if (!linked)
    take_out();
  return linked;
}

void
InnerDecoder::take_out()
{
  GST_OBJECT_LOCK(bin_);
  GstElement *decoder = std::exchange(decoder_, nullptr);
  GST_OBJECT_UNLOCK(bin_);
  if (decoder == nullptr)
    return;
  gst_ghost_pad_set_target(GST_GHOST_PAD(sink_), nullptr);
  gst_element_set_state(decoder, GST_STATE_NULL);
  if (gst_object_has_as_parent(GST_OBJECT(decoder), GST_OBJECT(bin_)))
    gst_bin_remove(bin_, decoder);
  gst_object_unref(decoder);
}
