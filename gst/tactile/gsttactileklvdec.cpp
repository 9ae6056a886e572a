// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-tactileklvdec
 * @title: tactileklvdec
 * @short_description: the tactile track of a transport stream as subtitles, for players
 *
 * tactileklvdec is #tactileconverter from KLV to text cues in the form of a decoder, which is what
 * players look for in an MPEG transport stream with a tactile track: without one, GStreamer tells
 * them that a plugin is missing. What comes out is what #tactilesubtitles takes. KLV of others has
 * no cues: a GAP.
 *
 * A stream's caps do not say whose KLV it is, and text is drawn where nothing else is made of it. So
 * decodebin takes this element only where its rank is raised, together with that of
 * #tactilesubtitles: `GST_PLUGIN_FEATURE_RANK=tactilesubtitles:MAX,tactileklvdec:MARGINAL`.
 *
 * ## Example launch line
 * |[
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile ! tactileextractor name=x \
 *     x.tactile ! tactileconverter ! meta/x-klv ! tactileklvdec ! webvttenc ! filesink location=track.vtt
 * ]|
 *
 * Since: 0.1
 */
#include "gsttactileklvdec.h"

#include "cuestream.h"
#include "gsttactileelements.h"

struct _GstTactileKlvDec
{
  GstBin parent;
};

G_DEFINE_TYPE(GstTactileKlvDec, gst_tactile_klv_dec, GST_TYPE_BIN);
GST_ELEMENT_REGISTER_DEFINE(tactileklvdec, "tactileklvdec", GST_RANK_NONE,
                            GST_TYPE_TACTILE_KLV_DEC);

static GstStaticPadTemplate sink_template
    = GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(CUE_KLV_CAPS));
static GstStaticPadTemplate src_template
    = GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(CUE_TEXT_CAPS));

static void
gst_tactile_klv_dec_class_init(GstTactileKlvDecClass *klass)
{
  auto *element_class = GST_ELEMENT_CLASS(klass);
  gst_element_class_add_static_pad_template(element_class, &sink_template);
  gst_element_class_add_static_pad_template(element_class, &src_template);
  gst_element_class_set_static_metadata(
      element_class, "Tactile KLV decoder", "Codec/Decoder/Subtitle",
      "Turns the tactile track of a transport stream into text cues", "The visuotactile authors");
}

static void
add_ghost(GstTactileKlvDec *self, GstElement *child, const gchar *name, GstStaticPadTemplate *of)
{
  g_autoptr(GstPad) target = gst_element_get_static_pad(child, name);
  g_autoptr(GstPadTemplate) pad_template = gst_static_pad_template_get(of);
  gst_element_add_pad(GST_ELEMENT(self),
                      gst_ghost_pad_new_from_template(name, target, pad_template));
}

static void
gst_tactile_klv_dec_init(GstTactileKlvDec *self)
{
  GstElement *converter = gst_element_factory_make("tactileconverter", "converter");
  GstElement *text = gst_element_factory_make("capsfilter", "text");
  g_autoptr(GstCaps) caps = cue_caps_new(CueForm::text);
  g_object_set(text, "caps", caps, nullptr);
  gst_bin_add_many(GST_BIN(self), converter, text, nullptr);
  gst_element_link(converter, text);
  add_ghost(self, converter, "sink", &sink_template);
  add_ghost(self, text, "src", &src_template);
}
