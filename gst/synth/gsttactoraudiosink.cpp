// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-tactoraudiosink
 * @title: tactoraudiosink
 * @short_description: plays tactile maps on shakers and voice coils at a sound card
 *
 * tactoraudiosink is a bin with `tactilesynth` (child `synth`), the channels of the sound card,
 * and #GstTactoraudiosink:audio-sink. [tactilesynth](tactilesynth.md) explains the conversion and
 * most properties, [shakers](../hardware/shakers.md) the hardware.
 *
 * The sound has the sample rate of the sink, if that is 8 to 192 kHz, because a resampler would
 * delay it.
 *
 * #GstTactoraudiosink:channels is the number of channels of the card: 2 (stereo), 4 (front and
 * back), 6 (5.1) or 8 (7.1). Maps play on back and side channels and on LFE, if there are any.
 * More than eight channels have no positions: cell i is channel i. #GstTactoraudiosink:mapping
 * assigns a channel to each cell.
 *
 * Put a queue that holds more than the rise time and 6 ms before each sink of a film. Sound ends
 * within 6 ms of the last map. A pause, a flush or an error stops the card, as with any audio
 * sink.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile ! tactileextractor name=x \
 *     x.src ! queue max-size-bytes=0 max-size-buffers=0 max-size-time=400000000 ! \
 *     videoconvert ! autovideosink \
 *     x.tactile ! queue ! tactoraudiosink intensity=0.5
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! saliencytactile rows=1 columns=2 ! \
 *     tactileextractor name=x x.tactile ! tactoraudiosink channels=4 mapping=2,3 frequency=80
 * ]|
 *
 * Since: 0.1
 */
#include "gsttactoraudiosink.h"

#include "synthsettings.h"

#include <gst/audio/audio.h>
#include <gst/tactile/tactile.h>

#include <utility>

struct _GstTactorAudioSink
{
  GstBin parent;

  /* Made at init. NULL where one's plugin is missing. */
  GstElement *synth;
  GstElement *format;
  GstElement *convert;

  GstElement *wanted; ///< audio-sink as set; owned; object lock
  GstElement
      *sink;      ///< the audio sink in the bin; written in changes of state, with the object lock
  guint channels; ///< object lock
};

#define gst_tactor_audio_sink_parent_class parent_class
G_DEFINE_TYPE(GstTactorAudioSink, gst_tactor_audio_sink, GST_TYPE_BIN);
GST_ELEMENT_REGISTER_DEFINE(tactoraudiosink, "tactoraudiosink", GST_RANK_NONE,
                            GST_TYPE_TACTOR_AUDIO_SINK);

static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE(
    "sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(GST_TACTILE_MAP_CAPS));

namespace {

/* Those of tactilesynth follow. */
enum Id : guint
{
  kAudioSink = 1,
  kChannels,
  kFirstOfSynth,
};

constexpr guint kStereo = 2;

/// Up to eight channels have positions: what a sound card has.
GstCaps *
caps_of(guint channels)
{
  constexpr guint kMostPlaces = 8;
  GstCaps *caps = gst_caps_new_simple("audio/x-raw", "channels", G_TYPE_INT,
                                      static_cast<gint>(channels), nullptr);
  const guint64 mask = channels > kMostPlaces
                           ? 0
                           : gst_audio_channel_get_fallback_mask(static_cast<gint>(channels));
  if (channels > 1)
    gst_caps_set_simple(caps, "channel-mask", GST_TYPE_BITMASK, mask, nullptr);
  return caps;
}

} // namespace

/* ---- state ---- */

static void
gst_tactor_audio_sink_replace(GstTactorAudioSink *self, GstElement *sink)
{
  GST_OBJECT_LOCK(self);
  GstElement *old = std::exchange(self->sink, nullptr);
  GST_OBJECT_UNLOCK(self);
  if (old != nullptr) {
    gst_element_set_state(old, GST_STATE_NULL);
    gst_bin_remove(GST_BIN(self), old);
  }
  const bool is_added = gst_bin_add(GST_BIN(self), sink);
  GST_OBJECT_LOCK(self);
  self->sink = is_added ? sink : nullptr;
  GST_OBJECT_UNLOCK(self);
}

/* NULL to READY: uses audio-sink. False after an error message. */
static bool
gst_tactor_audio_sink_open(GstTactorAudioSink *self)
{
  GST_OBJECT_LOCK(self);
  g_autoptr(GstElement) wanted = self->wanted ? GST_ELEMENT(gst_object_ref(self->wanted)) : nullptr;
  g_autoptr(GstCaps) caps = caps_of(self->channels);
  GST_OBJECT_UNLOCK(self);
  if (self->format == nullptr || (wanted == nullptr && self->sink == nullptr)) {
    GST_ELEMENT_ERROR(self, CORE, MISSING_PLUGIN,
                      ("tactoraudiosink needs capsfilter, audioconvert and autoaudiosink."),
                      ("expected GStreamer's base and good plugins"));
    return false;
  }
  if (wanted != nullptr && wanted != self->sink)
    gst_tactor_audio_sink_replace(self, wanted);
  g_autoptr(GstPad) last = gst_element_get_static_pad(self->convert, "src");
  if (self->sink == nullptr
      || (!gst_pad_is_linked(last) && !gst_element_link(self->convert, self->sink))) {
    GST_ELEMENT_ERROR(
        self, LIBRARY, SETTINGS, ("The audio sink cannot be used."),
        ("%s is in another bin or takes no sound", GST_OBJECT_NAME(wanted ? wanted : self->sink)));
    return false;
  }
  g_object_set(self->format, "caps", caps, nullptr);
  return true;
}

static GstStateChangeReturn
gst_tactor_audio_sink_change_state(GstElement *element, GstStateChange transition)
{
  if (transition == GST_STATE_CHANGE_NULL_TO_READY
      && !gst_tactor_audio_sink_open(GST_TACTOR_AUDIO_SINK(element)))
    return GST_STATE_CHANGE_FAILURE;
  return GST_ELEMENT_CLASS(parent_class)->change_state(element, transition);
}

/* ---- properties ---- */

static void
gst_tactor_audio_sink_set_property(GObject *object, guint id, const GValue *value,
                                   GParamSpec *pspec)
{
  auto *self = GST_TACTOR_AUDIO_SINK(object);
  if (id == kAudioSink) {
    auto *wanted = static_cast<GstElement *>(g_value_get_object(value));
    if (wanted == nullptr) // the usual one again
      wanted = gst_element_factory_make("autoaudiosink", nullptr);
    if (wanted != nullptr)
      gst_object_ref_sink(wanted);
    GST_OBJECT_LOCK(self);
    std::swap(self->wanted, wanted);
    GST_OBJECT_UNLOCK(self);
    gst_clear_object(&wanted);
  } else if (id == kChannels) {
    GST_OBJECT_LOCK(self);
    self->channels = g_value_get_uint(value);
    GST_OBJECT_UNLOCK(self);
  } else {
    g_object_set_property(G_OBJECT(self->synth), pspec->name, value);
  }
}

static void
gst_tactor_audio_sink_get_property(GObject *object, guint id, GValue *value, GParamSpec *pspec)
{
  auto *self = GST_TACTOR_AUDIO_SINK(object);
  if (id >= kFirstOfSynth) {
    g_object_get_property(G_OBJECT(self->synth), pspec->name, value);
    return;
  }
  GST_OBJECT_LOCK(self);
  if (id == kAudioSink)
    g_value_set_object(value, self->wanted ? self->wanted : self->sink);
  else
    g_value_set_uint(value, self->channels);
  GST_OBJECT_UNLOCK(self);
}

static void
gst_tactor_audio_sink_dispose(GObject *object)
{
  gst_clear_object(&GST_TACTOR_AUDIO_SINK(object)->wanted);
  G_OBJECT_CLASS(parent_class)->dispose(object);
}

static void
gst_tactor_audio_sink_class_init(GstTactorAudioSinkClass *klass)
{
  auto *object_class = G_OBJECT_CLASS(klass);
  auto *element_class = GST_ELEMENT_CLASS(klass);
  constexpr auto kFlags = static_cast<GParamFlags>(properties::kReady | G_PARAM_STATIC_STRINGS);

  object_class->dispose = gst_tactor_audio_sink_dispose;
  object_class->set_property = gst_tactor_audio_sink_set_property;
  object_class->get_property = gst_tactor_audio_sink_get_property;
  g_object_class_install_property(
      object_class, kAudioSink,
      g_param_spec_object("audio-sink", nullptr,
                          "Audio sink, from the next start on (unset: autoaudiosink)",
                          GST_TYPE_ELEMENT, kFlags));
  g_object_class_install_property(
      object_class, kChannels,
      g_param_spec_uint(
          "channels", nullptr,
          "Channels of the sound card, from the next start on; up to 8 have the usual "
          "positions",
          1, SynthSettings::kMostChannels, kStereo, kFlags));
  guint id = kFirstOfSynth;
  for (const auto &property : SynthSettings::table())
    g_object_class_install_property(object_class, id++, property.make_spec(SynthSettings()));

  element_class->change_state = GST_DEBUG_FUNCPTR(gst_tactor_audio_sink_change_state);
  gst_element_class_add_static_pad_template(element_class, &sink_template);
  gst_element_class_set_static_metadata(element_class, "Tactor audio sink", "Sink/Audio/Tactile",
                                        "Plays tactile maps on shakers at a sound card",
                                        "The visuotactile authors");
}

static void
gst_tactor_audio_sink_init(GstTactorAudioSink *self)
{
  self->channels = kStereo;
  self->synth = gst_element_factory_make("tactilesynth", "synth");
  GstElement *format = gst_element_factory_make("capsfilter", "format");
  GstElement *convert = gst_element_factory_make("audioconvert", "convert");
  gst_bin_add(GST_BIN(self), self->synth);
  g_autoptr(GstPad) target = gst_element_get_static_pad(self->synth, "sink");
  g_autoptr(GstPadTemplate) pad_template = gst_static_pad_template_get(&sink_template);
  gst_element_add_pad(GST_ELEMENT(self),
                      gst_ghost_pad_new_from_template("sink", target, pad_template));
  if (!format || !convert) {
    gst_clear_object(&format);
    gst_clear_object(&convert);
    return;
  }
  self->format = format;
  self->convert = convert;
  gst_bin_add_many(GST_BIN(self), format, convert, nullptr);
  gst_element_link_many(self->synth, format, convert, nullptr);
  self->sink = gst_element_factory_make("autoaudiosink", "audio-sink");
  if (self->sink != nullptr) { /* linked: an open pad would become one of the bin's in a line */
    gst_bin_add(GST_BIN(self), self->sink);
    gst_element_link(convert, self->sink);
  }
}
