// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-tactileklvdec
 * @title: tactileklvdec
 * @short_description: decodes tactile tracks of transport streams and of WebVTT in Matroska
 *
 * Players use tactileklvdec as the decoder of KLV in a transport stream with a tactile track, and
 * of the WebVTT that mkvmerge and FFmpeg put into Matroska, with the caps
 * `application/x-subtitle-unknown`. Without it, GStreamer reports a missing plugin.
 *
 * For a track, the element outputs no text. Each packet becomes a GAP event at its time. A packet
 * of a tactile track is in the field `tactile-packet` (a #GstBuffer) of this event, which
 * [tactilesubtitles](tactilesubtitles.md) and [tactileconverter](tactileconverter.md) read as a
 * cue. Players without these elements show the film normally.
 *
 * Caps do not identify the kind of KLV. Other KLV, such as a drone's, becomes gaps without a
 * packet. To receive such KLV, an application names `meta/x-klv` in decodebin's `caps`. WebVTT
 * that is not a track becomes text, without its tags.
 *
 * playbin3 of GStreamer 1.22 does not select KLV streams; playbin does:
 *
 * |[
 * GST_PLUGIN_FEATURE_RANK=tactilesubtitles:MAX gst-play-1.0 --videosink=visuotactilesink film.ts
 * ]|
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile ! tactileextractor name=x \
 *     x.tactile ! tactileconverter ! meta/x-klv ! tactileklvdec ! tactileconverter ! \
 *     tactorsink driver=simulator
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile ! tactileextractor name=x \
 *     x.tactile ! tactileconverter ! meta/x-klv ! tactileklvdec ! tactileconverter ! \
 *     webvttenc ! filesink location=track.vtt
 * ]|
 *
 * Since: 0.1
 */
#include "gsttactileklvdec.h"

#include "gst/cues/cue_stream.h"
#include "gsttactileelements.h"

#include <optional>
#include <string>
#include <utility>

GST_DEBUG_CATEGORY_STATIC(tactile_klv_dec_debug);
#define GST_CAT_DEFAULT tactile_klv_dec_debug

struct _GstTactileKlvDec
{
  GstElement parent;
  GstPad *srcpad;

  /* Streaming thread. */
  CueForm form;
  bool interrupted; ///< the next words do not follow the last ones
};

G_DEFINE_TYPE_WITH_CODE(GstTactileKlvDec, gst_tactile_klv_dec, GST_TYPE_ELEMENT,
                        GST_DEBUG_CATEGORY_INIT(tactile_klv_dec_debug, "tactileklvdec", 0,
                                                "the tactile track of a transport stream"));
GST_ELEMENT_REGISTER_DEFINE(tactileklvdec, "tactileklvdec", GST_RANK_MARGINAL,
                            GST_TYPE_TACTILE_KLV_DEC);

static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE(
    "sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(CUE_KLV_CAPS "; " CUE_WEBVTT_CAPS));
static GstStaticPadTemplate src_template
    = GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(CUE_TEXT_CAPS));

/* Words of WebVTT, without its tags; nullptr if the bytes are no text. */
static GstBuffer *
words_new(GstBuffer *block, CueForm form)
{
  GstMapInfo bytes;
  if (form == CueForm::klv || !gst_buffer_map(block, &bytes, GST_MAP_READ))
    return nullptr;
  std::string words;
  bool in_tag = false;
  for (const char c : cue_text({ reinterpret_cast<const char *>(bytes.data), bytes.size }, form)) {
    in_tag = in_tag || c == '<';
    if (!in_tag)
      words += c;
    in_tag = in_tag && c != '>';
  }
  gst_buffer_unmap(block, &bytes);
  if (words.empty() || !g_utf8_validate(words.data(), static_cast<gssize>(words.size()), nullptr))
    return nullptr;
  GstBuffer *buffer = gst_buffer_new_memdup(words.data(), words.size());
  gst_buffer_copy_into(buffer, block, GST_BUFFER_COPY_TIMESTAMPS, 0, static_cast<gsize>(-1));
  return buffer;
}

static GstFlowReturn
gst_tactile_klv_dec_chain(GstPad *pad, GstObject *parent, GstBuffer *packet)
{
  (void)pad;
  auto *self = GST_TACTILE_KLV_DEC(parent);
  g_autoptr(GstBuffer) owned = packet;
  const GstClockTime pts = GST_BUFFER_PTS(packet);
  self->interrupted |= GST_BUFFER_IS_DISCONT(packet);
  if (!GST_CLOCK_TIME_IS_VALID(pts))
    return GST_FLOW_OK;
  auto cue = cue_from_buffer(packet, self->form, std::nullopt);
  if (!cue) {
    GST_DEBUG_OBJECT(self, "packet at %" GST_TIME_FORMAT " is no map: %s", GST_TIME_ARGS(pts),
                     cue.error().text().c_str());
    if (GstBuffer *words = words_new(packet, self->form)) {
      if (std::exchange(self->interrupted, false))
        GST_BUFFER_FLAG_SET(words, GST_BUFFER_FLAG_DISCONT);
      return gst_pad_push(self->srcpad, words);
    }
    gst_pad_push_event(self->srcpad, gst_event_new_gap(pts, GST_CLOCK_TIME_NONE));
  } else if (self->form == CueForm::klv) {
    gst_pad_push_event(self->srcpad, cue_gap_new(packet));
  } else {
    const GstClockTime duration
        = GST_BUFFER_DURATION_IS_VALID(packet) ? GST_BUFFER_DURATION(packet) : GST_SECOND;
    cue->begin = tactile::Time(static_cast<tactile::Time::rep>(pts));
    cue->end = cue->begin + tactile::Time(static_cast<tactile::Time::rep>(duration));
    g_autoptr(GstBuffer) klv = cue_buffer_new(*cue, CueForm::klv);
    gst_pad_push_event(self->srcpad, cue_gap_new(klv));
  }
  return GST_FLOW_OK;
}

static gboolean
gst_tactile_klv_dec_sink_event(GstPad *pad, GstObject *parent, GstEvent *event)
{
  auto *self = GST_TACTILE_KLV_DEC(parent);
  if (GST_EVENT_TYPE(event) == GST_EVENT_FLUSH_STOP || GST_EVENT_TYPE(event) == GST_EVENT_SEGMENT)
    self->interrupted = true;
  if (GST_EVENT_TYPE(event) != GST_EVENT_CAPS)
    return gst_pad_event_default(pad, parent, event);
  GstCaps *of = nullptr;
  gst_event_parse_caps(event, &of);
  self->form = cue_form_of(of).value_or(CueForm::klv);
  gst_event_unref(event);
  g_autoptr(GstCaps) caps = cue_caps_new(CueForm::text);
  return gst_pad_push_event(self->srcpad, gst_event_new_caps(caps));
}

static void
gst_tactile_klv_dec_class_init(GstTactileKlvDecClass *klass)
{
  auto *element_class = GST_ELEMENT_CLASS(klass);
  gst_element_class_add_static_pad_template(element_class, &sink_template);
  gst_element_class_add_static_pad_template(element_class, &src_template);
  gst_element_class_set_static_metadata(
      element_class, "Tactile KLV decoder", "Codec/Decoder/Subtitle",
      "Turns tactile tracks in KLV or WebVTT into subtitles that show nothing",
      "The visuotactile authors");
}

static void
gst_tactile_klv_dec_init(GstTactileKlvDec *self)
{
  GstPad *sinkpad = gst_pad_new_from_static_template(&sink_template, "sink");
  gst_pad_set_chain_function(sinkpad, GST_DEBUG_FUNCPTR(gst_tactile_klv_dec_chain));
  gst_pad_set_event_function(sinkpad, GST_DEBUG_FUNCPTR(gst_tactile_klv_dec_sink_event));
  gst_element_add_pad(GST_ELEMENT(self), sinkpad);

  self->srcpad = gst_pad_new_from_static_template(&src_template, "src");
  gst_pad_use_fixed_caps(self->srcpad);
  gst_element_add_pad(GST_ELEMENT(self), self->srcpad);
}
