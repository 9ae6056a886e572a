// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-visuotactiledecoder
 * @title: visuotactiledecoder
 * @short_description: a video decoder that also plays a chair, for players with their own sink
 *
 * visuotactiledecoder uses the video decoder that a player would use without it, and plays the
 * film on the motors of a chair. The player keeps its video sink, window and controls. The element
 * is a bin with the decoder, `saliencytactile` (child `analysis`) and `tactorsink` (child
 * `tactors`).
 *
 * playbin and decodebin use it in the programs that the [settings of the
 * user](../guide/players.md) enable. Its rank is NONE if no program is enabled; then name the
 * element, or set `GST_PLUGIN_FEATURE_RANK=visuotactiledecoder:MAX`.
 *
 * - Frames reach the player unchanged and without delay. Frames of a live source are delayed by
 *   #GstTactorSink:max-lead and 30 ms.
 * - The picture never waits for the chair. If the analysis is too slow, frames are not felt.
 * - If the tactors fail, the film plays on, with a warning; the next start tries again. Frames in
 *   a GPU's memory stay there: see [saliencytactile](saliencytactile.md). Unreadable frames are
 *   shown and not felt.
 * - If a process plays several films, the chair plays the one with the largest picture, or the
 *   first of equal ones. A paused film keeps the chair while no other one plays.
 * - In gapless playback of playbin3 with one decoder, the chair plays each film in sync from the
 *   first QoS event of the player's sink on, which has its start. Sinks with `qos=false` send
 *   none.
 * - Impacts in the sound are felt if a [soundtactile](soundtactile.md) is in the same pipeline;
 *   `sound::sound` is the property of visuotactilesink. Frames of a live source are then delayed
 *   by another 137 ms.
 * - Frame steps and instant rate changes reach the player's sink only, not the motors.
 * - A parser precedes the decoder if the decoder needs one.
 *
 * ## Example launch line
 * |[
 * gst-launch-1.0 tactiletestsrc num-buffers=150 ! jpegenc ! \
 *     visuotactiledecoder tactors::driver=simulator tactors::trace-location=commands.csv ! \
 *     videoconvert ! autovideosink
 * ]|
 *
 * Since: 0.1
 */
#include "gstvisuotactiledecoder.h"

#include "../latency.h"
#include "../pooldemand.h"
#include "chairproperties.h"
#include "chairturns.h"
#include "frametap.h"
#include "innerdecoder.h"
#include "tactilebranch.h"
#include "twostreams.h"

#include <gst/base/gstbasesink.h>

#include <atomic>
#include <utility>

GST_DEBUG_CATEGORY(visuotactile_decoder_debug);
#define GST_CAT_DEFAULT visuotactile_decoder_debug

namespace {

/// Time of the analysis, for which frames of a live source wait beyond the lead of the motors.
constexpr GstClockTime kAnalysisMargin = 20 * GST_MSECOND;

/// How far the decoder may run ahead of the player. Maps come earlier than their frames by that.
constexpr GstClockTime kAhead = 400 * GST_MSECOND;

/// The same for frames without times.
constexpr guint kMostAhead = 64;

/// Frames that wait for the analysis.
constexpr guint kMoreFrames = 6;

} // namespace

struct _GstVisuotactileDecoder
{
  GstBin parent;

  GstPad *sinkpad;
  GstPad *srcpad;
  GstElement *queue; ///< behind the decoder; owned
  InnerDecoder *decoder;
  GstTactileBranch *branch; ///< owned; NULL where a plugin is missing
  PlayGate *gate;           ///< NULL where a plugin is missing, as the tap
  FrameTap *tap;
  ChairProperties *properties; ///< NULL where a plugin is missing
  std::atomic_bool playing;    ///< in PLAYING

  /* State lock. */
  gboolean plays; ///< from PAUSED on
  gboolean felt;  ///< the film has the chair
};

static void gst_visuotactile_decoder_child_proxy_init(gpointer iface, gpointer);

#define gst_visuotactile_decoder_parent_class parent_class
G_DEFINE_TYPE_WITH_CODE(GstVisuotactileDecoder, gst_visuotactile_decoder, GST_TYPE_BIN,
                        G_IMPLEMENT_INTERFACE(GST_TYPE_CHILD_PROXY,
                                              gst_visuotactile_decoder_child_proxy_init)
                            GST_DEBUG_CATEGORY_INIT(visuotactile_decoder_debug,
                                                    "visuotactiledecoder", 0,
                                                    "video decoder with a chair"));

/// Before all decoders where a program is switched on; those that are not get another one.
static gboolean
gst_visuotactile_decoder_register(GstPlugin *plugin)
{
  const guint rank = chair::any_enabled() ? GST_RANK_PRIMARY + 1000 : GST_RANK_NONE;
  return gst_element_register(plugin, "visuotactiledecoder", rank, GST_TYPE_VISUOTACTILE_DECODER);
}
GST_ELEMENT_REGISTER_DEFINE_CUSTOM(visuotactiledecoder, gst_visuotactile_decoder_register);

// Caps that players look for; which of them can be decoded is known at runtime.
static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE(
    "sink", GST_PAD_SINK, GST_PAD_ALWAYS,
    GST_STATIC_CAPS("video/x-h264; video/x-h265; video/x-vp8; video/x-vp9; video/x-av1; "
                    "video/mpeg, mpegversion=(int)[1,4], systemstream=(boolean)false; image/jpeg; "
                    "video/x-theora; video/x-divx; video/x-xvid; video/x-msmpeg; video/x-h263; "
                    "video/x-wmv; video/x-flash-video; video/x-vp6; video/x-vp6-flash; "
                    "video/x-pn-realvideo; video/x-dirac; video/x-prores; video/x-dnxhd; "
                    "video/x-dv, systemstream=(boolean)false; video/x-svq; video/x-cinepak; "
                    "video/x-indeo; video/x-huffyuv; video/x-ffv; image/x-jpc"));
// System memory is listed too: playbin counts the caps features in common with a sink.
static GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE(
    "src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS("video/x-raw; video/x-raw(ANY)"));

/* ---- the decoder ---- */

static gboolean
gst_visuotactile_decoder_sink_query(GstPad *pad, GstObject *parent, GstQuery *query)
{
  auto *self = GST_VISUOTACTILE_DECODER(parent);
  GstCaps *asked = nullptr;

  switch (GST_QUERY_TYPE(query)) {
  case GST_QUERY_CAPS: {
    gst_query_parse_caps(query, &asked);
    g_autoptr(GstCaps) caps = self->decoder->caps(asked);
    gst_query_set_caps_result(query, caps);
    return TRUE;
  }
  case GST_QUERY_ACCEPT_CAPS:
    gst_query_parse_accept_caps(query, &asked);
    gst_query_set_accept_caps_result(query, self->decoder->accept(asked, false));
    return TRUE;
  default:
    return gst_pad_query_default(pad, parent, query);
  }
}

static gboolean
gst_visuotactile_decoder_sink_event(GstPad *pad, GstObject *parent, GstEvent *event)
{
  GstCaps *caps = nullptr;
  if (GST_EVENT_TYPE(event) == GST_EVENT_CAPS) {
    gst_event_parse_caps(event, &caps);
    if (!GST_VISUOTACTILE_DECODER(parent)->decoder->accept(caps, true)) {
      gst_event_unref(event);
      return FALSE;
    }
  }
  return gst_pad_event_default(pad, parent, event);
}

/* ---- the picture ---- */

/// Delay of the frames of a live source because of the chair.
static GstClockTime
gst_visuotactile_decoder_live_latency(GstVisuotactileDecoder *self)
{
  if (self->branch == nullptr || gst_element_is_locked_state(GST_ELEMENT(self->branch)))
    return 0;
  GstElement *tactors = gst_tactile_branch_get_tactors(self->branch);
  return gst_base_sink_get_render_delay(GST_BASE_SINK(tactors)) + kAnalysisMargin
         + gst_sound_join_most_latency(gst_tactile_branch_get_sound(self->branch));
}

static gboolean
gst_visuotactile_decoder_src_query(GstPad *pad, GstObject *parent, GstQuery *query)
{
  const gboolean answered = gst_pad_query_default(pad, parent, query);
  if (!answered || GST_QUERY_TYPE(query) != GST_QUERY_LATENCY)
    return answered;
  if (latency::is_live(query))
    latency::add(query, gst_visuotactile_decoder_live_latency(GST_VISUOTACTILE_DECODER(parent)));
  return TRUE;
}

/// Adds the frames that wait here to the pools of decoders.
static gboolean
gst_visuotactile_decoder_inner_query(GstPad *pad, GstObject *parent, GstQuery *query)
{
  const gboolean answered = gst_pad_query_default(pad, parent, query);
  if (GST_QUERY_TYPE(query) != GST_QUERY_ALLOCATION)
    return answered;
  demand_buffers(query, kAhead, kMoreFrames);
  return TRUE;
}

static GstPadProbeReturn
gst_visuotactile_decoder_sinks_event(GstPad *, GstPadProbeInfo *info, gpointer user_data)
{
  auto *self = GST_VISUOTACTILE_DECODER(user_data);
  GstEvent *event = GST_PAD_PROBE_INFO_EVENT(info);
  self->tap->hear(event);
  if (GST_EVENT_TYPE(event) == GST_EVENT_LATENCY)
    gst_element_send_event(gst_tactile_branch_get_tactors(self->branch), gst_event_ref(event));
  return GST_PAD_PROBE_OK;
}

/* ---- the chair ---- */

static void gst_visuotactile_decoder_offered(GstElement *element, gpointer);
static void gst_visuotactile_decoder_asked(GstElement *element, gpointer);

/// Any thread.
static ChairTurns::Claim
gst_visuotactile_decoder_claim(GstVisuotactileDecoder *self)
{
  using State = ChairTurns::Claim::State;
  const State state = self->tap->ended() ? State::kEnded
                      : self->playing    ? State::kPlays
                                         : State::kPaused;
  return { state, self->tap->pixels() };
}

/// The film begins, ends, plays or is paused, or its picture has another size.
static void
gst_visuotactile_decoder_changed(GstVisuotactileDecoder *self)
{
  ChairTurns::of_process().claim(GST_ELEMENT(self), gst_visuotactile_decoder_claim(self));
}

/// Taps the film if it is its turn. Otherwise the elements of the chair are in READY.
static void
gst_visuotactile_decoder_take_chair(GstVisuotactileDecoder *self)
{
  self->felt = ChairTurns::of_process().take(
      { GST_ELEMENT(self), gst_visuotactile_decoder_offered, gst_visuotactile_decoder_asked },
      gst_visuotactile_decoder_claim(self));
  gst_element_set_locked_state(GST_ELEMENT(self->branch), !self->felt);
  if (self->felt)
    self->tap->start();
  else
    GST_INFO_OBJECT(self, "another film is felt");
}

static void
gst_visuotactile_decoder_leave_chair(GstVisuotactileDecoder *self)
{
  if (self->tap)
    self->tap->stop();
  self->felt = FALSE;
  ChairTurns::of_process().leave(GST_ELEMENT(self));
}

/// Takes the chair in the middle of a film. With the state lock. Returns whether it begins.
static bool
gst_visuotactile_decoder_join(GstVisuotactileDecoder *self)
{
  if (!self->plays || self->felt)
    return false;
  gst_visuotactile_decoder_take_chair(self);
  if (self->felt)
    gst_element_sync_state_with_parent(GST_ELEMENT(self->branch));
  return self->felt;
}

static void
gst_visuotactile_decoder_post_latency(GstElement *element, gpointer)
{
  if (latency::is_live(GST_VISUOTACTILE_DECODER(element)->sinkpad))
    gst_element_post_message(element, gst_message_new_latency(GST_OBJECT(element)));
}

/// The chair is free.
static void
gst_visuotactile_decoder_offered(GstElement *element, gpointer)
{
  auto *self = GST_VISUOTACTILE_DECODER(element);
  GST_STATE_LOCK(self);
  const bool begins = gst_visuotactile_decoder_join(self);
  GST_STATE_UNLOCK(self);
  // A film that waited for the chair has no latency for it yet.
  if (begins)
    gst_visuotactile_decoder_post_latency(element, nullptr);
}

/// Another film plays, which may count more.
static void
gst_visuotactile_decoder_asked(GstElement *element, gpointer)
{
  auto *self = GST_VISUOTACTILE_DECODER(element);
  GST_STATE_LOCK(self);
  if (self->felt && ChairTurns::of_process().outranked(element)) {
    gst_element_set_locked_state(GST_ELEMENT(self->branch), TRUE);
    gst_element_set_state(GST_ELEMENT(self->branch), GST_STATE_READY);
    gst_visuotactile_decoder_leave_chair(self);
    gst_visuotactile_decoder_join(self); // waits, unless the other has gone
  }
  GST_STATE_UNLOCK(self);
}

/// Messages of the chair do not concern the film. Its latency is that of the source pad, which
/// sinks query when they preroll. A LATENCY message during that preroll sometimes stops pulsesink.
/// Therefore one is posted only in a live film that plays.
static void
gst_visuotactile_decoder_handle_message(GstBin *bin, GstMessage *message)
{
  auto *self = GST_VISUOTACTILE_DECODER(bin);
  const bool of_chair
      = self->branch
        && gst_object_has_as_ancestor(GST_MESSAGE_SRC(message), GST_OBJECT(self->branch));
  constexpr guint kSinks = GST_MESSAGE_EOS | GST_MESSAGE_ASYNC_START | GST_MESSAGE_ASYNC_DONE
                           | GST_MESSAGE_LATENCY | GST_MESSAGE_STREAM_START | GST_MESSAGE_QOS
                           | GST_MESSAGE_SEGMENT_START | GST_MESSAGE_SEGMENT_DONE
                           | GST_MESSAGE_RESET_TIME;
  // Extended types are numbers, not bits.
  if (!of_chair || GST_MESSAGE_TYPE_IS_EXTENDED(message) || !(GST_MESSAGE_TYPE(message) & kSinks)) {
    GST_BIN_CLASS(parent_class)->handle_message(bin, message);
    return;
  }
  // The player has switched the sound on or off, or the device is open and reports its latency.
  if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_LATENCY && self->playing)
    gst_element_call_async(GST_ELEMENT(self), gst_visuotactile_decoder_post_latency, nullptr,
                           nullptr);
  gst_message_unref(message);
}

/// NULL to READY: applies the user's settings. Where they switch it off, decodebin takes the next
/// decoder. An error message would end the film in some players.
static bool
gst_visuotactile_decoder_open(GstVisuotactileDecoder *self)
{
  const chair::Settings settings = self->properties->open();
  if (settings.enabled(!settings.others))
    return true;
  GST_INFO_OBJECT(self, "switched off for this program");
  self->properties->close();
  return false;
}

static GstStateChangeReturn
gst_visuotactile_decoder_change_state(GstElement *element, GstStateChange transition)
{
  auto *self = GST_VISUOTACTILE_DECODER(element);

  if (transition == GST_STATE_CHANGE_NULL_TO_READY && self->branch == nullptr) {
    GST_ELEMENT_ERROR(
        self, CORE, MISSING_PLUGIN,
        ("visuotactiledecoder needs saliencytactile, tactileextractor and tactorsink."),
        ("expected the plugins saliency, tactile and tactor beside this one"));
    return GST_STATE_CHANGE_FAILURE;
  }
  if (transition == GST_STATE_CHANGE_NULL_TO_READY && !gst_visuotactile_decoder_open(self))
    return GST_STATE_CHANGE_FAILURE;
  if (transition == GST_STATE_CHANGE_READY_TO_PAUSED) {
    self->plays = TRUE;
    self->tap->begin();
    gst_visuotactile_decoder_take_chair(self);
  }
  const GstStateChangeReturn ret
      = GST_ELEMENT_CLASS(parent_class)->change_state(element, transition);
  const GstState next = GST_STATE_TRANSITION_NEXT(transition);
  if (self->gate && (next == GST_STATE_PLAYING || next <= GST_STATE_READY))
    self->gate->open();
  if (transition == GST_STATE_CHANGE_PAUSED_TO_PLAYING
      || transition == GST_STATE_CHANGE_PLAYING_TO_PAUSED) {
    self->playing = next == GST_STATE_PLAYING && ret != GST_STATE_CHANGE_FAILURE;
    gst_visuotactile_decoder_changed(self);
  }
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY
      || (transition == GST_STATE_CHANGE_READY_TO_PAUSED && ret == GST_STATE_CHANGE_FAILURE)) {
    self->plays = FALSE;
    gst_visuotactile_decoder_leave_chair(self);
    gst_element_set_locked_state(GST_ELEMENT(self->branch), FALSE);
  }
  if (transition == GST_STATE_CHANGE_READY_TO_NULL
      || (transition == GST_STATE_CHANGE_NULL_TO_READY && ret == GST_STATE_CHANGE_FAILURE)) {
    self->properties->close();
    self->decoder->remove();
  }
  return ret;
}

/* ---- children ---- */

/// Finds children by name, those of the chair also while they are out of it.
static GObject *
gst_visuotactile_decoder_get_child_by_name(GstChildProxy *proxy, const gchar *name)
{
  auto *self = GST_VISUOTACTILE_DECODER(proxy);
  if (self->branch && g_strcmp0(name, "tactors") == 0)
    return G_OBJECT(gst_object_ref(gst_tactile_branch_get_tactors(self->branch)));
  if (self->branch && g_strcmp0(name, "analysis") == 0)
    return G_OBJECT(gst_object_ref(gst_tactile_branch_get_analysis(self->branch)));
  if (self->branch && g_strcmp0(name, "sound") == 0)
    return G_OBJECT(gst_object_ref(gst_tactile_branch_get_sound(self->branch)));
  return G_OBJECT(gst_bin_get_by_name(GST_BIN(self), name));
}

static void
gst_visuotactile_decoder_child_proxy_init(gpointer iface, gpointer)
{
  // Children by index are the bin's.
  static_cast<GstChildProxyInterface *>(iface)->get_child_by_name
      = gst_visuotactile_decoder_get_child_by_name;
}

static void
gst_visuotactile_decoder_dispose(GObject *object)
{
  auto *self = GST_VISUOTACTILE_DECODER(object);
  self->decoder->remove();
  gst_visuotactile_decoder_leave_chair(self);
  delete std::exchange(self->tap, nullptr);
  delete std::exchange(self->gate, nullptr);
  delete std::exchange(self->properties, nullptr);
  gst_clear_object(&self->branch);
  gst_clear_object(&self->queue);
  G_OBJECT_CLASS(parent_class)->dispose(object);
}

static void
gst_visuotactile_decoder_finalize(GObject *object)
{
  delete GST_VISUOTACTILE_DECODER(object)->decoder;
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

static void
gst_visuotactile_decoder_class_init(GstVisuotactileDecoderClass *klass)
{
  GstElementClass *element_class = GST_ELEMENT_CLASS(klass);

  G_OBJECT_CLASS(klass)->dispose = gst_visuotactile_decoder_dispose;
  G_OBJECT_CLASS(klass)->finalize = gst_visuotactile_decoder_finalize;
  element_class->change_state = GST_DEBUG_FUNCPTR(gst_visuotactile_decoder_change_state);
  GST_BIN_CLASS(klass)->handle_message = GST_DEBUG_FUNCPTR(gst_visuotactile_decoder_handle_message);
  gst_element_class_add_static_pad_template(element_class, &sink_template);
  gst_element_class_add_static_pad_template(element_class, &src_template);
  gst_element_class_set_static_metadata(
      element_class, "Visuotactile decoder", "Codec/Decoder/Video",
      "Decodes a film and plays the events that draw the eye on motors",
      "The visuotactile authors");
}

/// The branch that is felt. It has none if a plugin is missing, and opening fails.
static void
gst_visuotactile_decoder_build(GstVisuotactileDecoder *self)
{
  self->branch = gst_tactile_branch_new_with_analysis("chair");
  if (self->branch == nullptr)
    return;
  gst_object_ref_sink(self->branch);
  // The bin, which prerolls with the picture, never waits for it.
  g_object_set(gst_tactile_branch_get_tactors(self->branch), "async", FALSE, nullptr);
  gst_bin_add(GST_BIN(self), GST_ELEMENT(self->branch));
  self->properties = new ChairProperties(
      GST_ELEMENT(self),
      { gst_tactile_branch_get_analysis(self->branch), gst_tactile_branch_get_tactors(self->branch),
        GST_ELEMENT(gst_tactile_branch_get_sound(self->branch)) });
}

static void
gst_visuotactile_decoder_init(GstVisuotactileDecoder *self)
{
  gst_bin_set_suppressed_flags(
      GST_BIN(self),
      static_cast<GstElementFlags>(GST_ELEMENT_FLAG_SINK | GST_ELEMENT_FLAG_REQUIRE_CLOCK));
  gst_visuotactile_decoder_build(self);
  self->queue = gst_element_factory_make("queue", "video-queue");
  gst_object_ref_sink(self->queue);
  let_streams_follow(self->queue);
  g_object_set(self->queue, "max-size-bytes", 0, "max-size-buffers", kMostAhead, "max-size-time",
               kAhead, nullptr);
  gst_bin_add(GST_BIN(self), self->queue);

  g_autoptr(GstPadTemplate) sink_pads = gst_static_pad_template_get(&sink_template);
  self->sinkpad = gst_ghost_pad_new_no_target_from_template("sink", sink_pads);
  gst_pad_set_query_function(self->sinkpad, GST_DEBUG_FUNCPTR(gst_visuotactile_decoder_sink_query));
  gst_pad_set_event_function(self->sinkpad, GST_DEBUG_FUNCPTR(gst_visuotactile_decoder_sink_event));
  self->decoder = new InnerDecoder(GST_BIN(self), self->sinkpad, self->queue);
  gst_element_add_pad(GST_ELEMENT(self), self->sinkpad);

  g_autoptr(GstPad) last = gst_element_get_static_pad(self->queue, "src");
  g_autoptr(GstPadTemplate) src_pads = gst_static_pad_template_get(&src_template);
  self->srcpad = gst_ghost_pad_new_from_template("src", last, src_pads);
  gst_pad_set_query_function(self->srcpad, GST_DEBUG_FUNCPTR(gst_visuotactile_decoder_src_query));
  g_autoptr(GstProxyPad) inside = gst_proxy_pad_get_internal(GST_PROXY_PAD(self->srcpad));
  gst_pad_set_query_function(GST_PAD(inside),
                             GST_DEBUG_FUNCPTR(gst_visuotactile_decoder_inner_query));
  gst_element_add_pad(GST_ELEMENT(self), self->srcpad);

  if (self->branch == nullptr)
    return;
  g_autoptr(GstPad) watched = gst_element_get_static_pad(self->queue, "sink");
  g_autoptr(GstPad) chair = gst_element_get_static_pad(GST_ELEMENT(self->branch), "sink");
  g_autoptr(GstPad) maps = gst_tactile_branch_get_maps_pad(self->branch);
  self->gate = new PlayGate(GST_ELEMENT(self), maps);
  self->tap = new FrameTap(watched, chair, *self->gate,
                           [self] { gst_visuotactile_decoder_changed(self); });
  gst_pad_add_probe(self->srcpad, GST_PAD_PROBE_TYPE_EVENT_UPSTREAM,
                    gst_visuotactile_decoder_sinks_event, self, nullptr);
}
