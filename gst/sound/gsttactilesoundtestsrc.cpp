// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-tactilesoundtestsrc
 * @title: tactilesoundtestsrc
 * @short_description: makes sounds that are to be felt, and others, with ground truth
 *
 * tactilesoundtestsrc makes impacts, explosions, rumble and music in mono, stereo, 5.1 and 7.1. A
 * sound depends only on the properties and its time: it is the same at any rate and after any seek.
 * Silence follows after #GstTactileSoundTestSrc:seconds.
 *
 * ## Ground truth
 * With the buffer in which a sound begins comes an element message `tactile-sound`:
 * - `kind` (string): impact, explosion, rumble or music (a note),
 * - `begin`, `end` (guint64): stream time in nanoseconds; at the end it has fallen by 20 dB,
 * - `across` (double): −1 left, 1 right,
 * - `behind` (double): 0 in front, 1 behind.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 tactilesoundtestsrc num-buffers=300 music=true ! audioconvert ! autoaudiosink
 * gst-launch-1.0 -m tactilesoundtestsrc num-buffers=300 explosions=true ! \
 *     audio/x-raw,channels=6 ! soundtactile name=s s.src ! queue ! fakesink \
 *     s.tactile ! queue ! tactorsink rate=0 driver=simulator
 * ]|
 *
 * Since: 0.1
 */
#include "gsttactilesoundtestsrc.h"

#include "../properties.h"
#include "gstsoundelements.h"
#include "sound/synthetic_sound.h"

#include <gst/audio/audio.h>

#include <algorithm>
#include <optional>

GST_DEBUG_CATEGORY_STATIC(tactile_sound_test_src_debug);
#define GST_CAT_DEFAULT tactile_sound_test_src_debug

namespace {

using sound::SoundKind;
using sound::SoundSettings;

constexpr gint kUsualRate = 48000;
constexpr gint64 kBlock = 1024; ///< frames of a buffer

struct Private
{
  SoundSettings settings; ///< object lock

  // Streaming thread, or while it is stopped.
  GstAudioInfo info{};
  std::optional<sound::SyntheticSound> made;
  gint64 frame = 0;                     ///< the next one
  std::optional<GstClockTime> start_at; ///< of a seek or of new caps, until the rate is known
};

const gchar *
name_of(SoundKind kind)
{
  switch (kind) {
  case SoundKind::impact:
    return "impact";
  case SoundKind::explosion:
    return "explosion";
  case SoundKind::rumble:
    return "rumble";
  default:
    return "music";
  }
}

} // namespace

struct _GstTactileSoundTestSrc
{
  GstPushSrc parent;
  Private *priv;
};

#define gst_tactile_sound_test_src_parent_class parent_class
G_DEFINE_TYPE_WITH_CODE(GstTactileSoundTestSrc, gst_tactile_sound_test_src, GST_TYPE_PUSH_SRC,
                        GST_DEBUG_CATEGORY_INIT(tactile_sound_test_src_debug, "tactilesoundtestsrc",
                                                0, "synthetic sounds with ground truth"));
GST_ELEMENT_REGISTER_DEFINE(tactilesoundtestsrc, "tactilesoundtestsrc", GST_RANK_NONE,
                            GST_TYPE_TACTILE_SOUND_TEST_SRC);

#define FORMAT                                                                                     \
  "audio/x-raw, format = (string) " GST_AUDIO_NE(                                                  \
      F32) ", layout = (string) interleaved, rate = (int) [ 8000, 192000 ], channels = (int) "

static GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE(
    "src", GST_PAD_SRC, GST_PAD_ALWAYS,
    GST_STATIC_CAPS(FORMAT "2, channel-mask = (bitmask) 0x3; " FORMAT "1; " FORMAT
                           "6, channel-mask = (bitmask) 0x3f; " FORMAT
                           "8, channel-mask = (bitmask) 0xc3f"));

static GstCaps *
gst_tactile_sound_test_src_fixate(GstBaseSrc *base, GstCaps *caps)
{
  caps = gst_caps_truncate(gst_caps_make_writable(caps));
  gst_structure_fixate_field_nearest_int(gst_caps_get_structure(caps, 0), "rate", kUsualRate);
  return GST_BASE_SRC_CLASS(parent_class)->fixate(base, caps);
}

static GstClockTime
time_of(const Private &priv, gint64 frame)
{
  return gst_util_uint64_scale_int(static_cast<guint64>(frame), GST_SECOND,
                                   GST_AUDIO_INFO_RATE(&priv.info));
}

static gboolean
gst_tactile_sound_test_src_set_caps(GstBaseSrc *base, GstCaps *caps)
{
  Private *priv = GST_TACTILE_SOUND_TEST_SRC(base)->priv;
  // The sound continues at the new rate.
  if (!priv->start_at && GST_AUDIO_INFO_IS_VALID(&priv->info))
    priv->start_at = time_of(*priv, priv->frame);
  if (!gst_audio_info_from_caps(&priv->info, caps)) {
    GST_ERROR_OBJECT(base, "expected caps of raw audio, got %" GST_PTR_FORMAT, caps);
    return FALSE;
  }
  return TRUE;
}

static gboolean
gst_tactile_sound_test_src_start(GstBaseSrc *base)
{
  Private *priv = GST_TACTILE_SOUND_TEST_SRC(base)->priv;
  gst_audio_info_init(&priv->info);
  priv->frame = 0;
  priv->start_at.reset();
  GST_OBJECT_LOCK(base);
  const SoundSettings settings = priv->settings;
  GST_OBJECT_UNLOCK(base);
  priv->made.emplace(settings);
  return TRUE;
}

static gboolean
gst_tactile_sound_test_src_stop(GstBaseSrc *base)
{
  GST_TACTILE_SOUND_TEST_SRC(base)->priv->made.reset();
  return TRUE;
}

static gboolean
gst_tactile_sound_test_src_is_seekable(GstBaseSrc *base)
{
  (void)base;
  return TRUE;
}

static gboolean
gst_tactile_sound_test_src_do_seek(GstBaseSrc *base, GstSegment *segment)
{
  Private *priv = GST_TACTILE_SOUND_TEST_SRC(base)->priv;
  if (segment->rate < 0) {
    GST_WARNING_OBJECT(base, "sounds are not played backwards");
    return FALSE;
  }
  segment->time = segment->start;
  priv->start_at = segment->position;
  return TRUE;
}

static void
post_events(GstTactileSoundTestSrc *self, GstClockTime from, GstClockTime to)
{
  for (const sound::SoundEvent &event : self->priv->made->events()) {
    const auto begin = static_cast<guint64>(event.begin.count());
    if (begin < from || begin >= to)
      continue;
    GstStructure *truth = gst_structure_new(
        "tactile-sound", "kind", G_TYPE_STRING, name_of(event.kind), "begin", G_TYPE_UINT64, begin,
        "end", G_TYPE_UINT64, static_cast<guint64>(event.end.count()), "across", G_TYPE_DOUBLE,
        event.across, "behind", G_TYPE_DOUBLE, event.behind, nullptr);
    gst_element_post_message(GST_ELEMENT(self), gst_message_new_element(GST_OBJECT(self), truth));
  }
}

static GstFlowReturn
gst_tactile_sound_test_src_create(GstPushSrc *src, GstBuffer **buffer)
{
  auto *self = GST_TACTILE_SOUND_TEST_SRC(src);
  Private *priv = self->priv;
  const gint rate = GST_AUDIO_INFO_RATE(&priv->info);
  if (priv->start_at)
    priv->frame
        = static_cast<gint64>(gst_util_uint64_scale_int_round(*priv->start_at, rate, GST_SECOND));
  priv->start_at.reset();

  const GstSegment &segment = GST_BASE_SRC(src)->segment;
  const GstClockTime from = time_of(*priv, priv->frame);
  if (GST_CLOCK_TIME_IS_VALID(segment.stop) && from >= segment.stop)
    return GST_FLOW_EOS;
  const auto channels = static_cast<gsize>(GST_AUDIO_INFO_CHANNELS(&priv->info));
  *buffer = gst_buffer_new_allocate(nullptr, kBlock * channels * sizeof(float), nullptr);
  GstMapInfo memory;
  if (!gst_buffer_map(*buffer, &memory, GST_MAP_WRITE)) {
    gst_clear_buffer(buffer);
    return GST_FLOW_ERROR;
  }
  priv->made->render(rate, priv->frame, sound::usual_speakers(static_cast<int>(channels)),
                     { reinterpret_cast<float *>(memory.data), kBlock * channels });
  gst_buffer_unmap(*buffer, &memory);

  GST_BUFFER_OFFSET(*buffer) = static_cast<guint64>(priv->frame);
  priv->frame += kBlock;
  GST_BUFFER_OFFSET_END(*buffer) = static_cast<guint64>(priv->frame);
  const GstClockTime to = time_of(*priv, priv->frame);
  GST_BUFFER_PTS(*buffer) = from;
  GST_BUFFER_DURATION(*buffer) = to - from;
  post_events(self, from, to);
  return GST_FLOW_OK;
}

using P = properties::Property<SoundSettings>;
static constexpr P kProperties[] = {
  P::number<guint64>("seed", "Number of the sound: same seed, same sound", properties::kReady,
                     PROPERTY_FIELD(seed)),
  P::number<gdouble>("seconds", "Length of the sound in s; silence follows", properties::kReady,
                     PROPERTY_FIELD(seconds), P::Range{ 0, 3600 }),
  P::flag("impacts", "Impacts, one every 0.8 to 2 s", properties::kReady, PROPERTY_FIELD(impacts)),
  P::flag("explosions", "Explosions, one every 5 to 9 s", properties::kReady,
          PROPERTY_FIELD(explosions)),
  P::flag("rumble", "Rumble, every 6 to 10 s", properties::kReady, PROPERTY_FIELD(rumble)),
  P::flag("music", "Music: bass, chords, melody and hi-hats", properties::kReady,
          PROPERTY_FIELD(music)),
  P::number<gdouble>("impacts-db",
                     "Root mean square of an impact's first 100 ms, in dB of full scale",
                     properties::kReady, PROPERTY_FIELD(impacts_db), P::Range{ -90, 0 }),
  P::number<gdouble>("music-db", "Root mean square of the music, in dB of full scale",
                     properties::kReady, PROPERTY_FIELD(music_db), P::Range{ -90, 0 }),
  P::flag("panned", "Each sound has its own place; otherwise all are at the center of the front",
          properties::kReady, PROPERTY_FIELD(panned)),
};

static SoundSettings &
gst_tactile_sound_test_src_settings(GObject *object)
{
  return GST_TACTILE_SOUND_TEST_SRC(object)->priv->settings;
}

static void
gst_tactile_sound_test_src_finalize(GObject *object)
{
  delete GST_TACTILE_SOUND_TEST_SRC(object)->priv;
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

static void
gst_tactile_sound_test_src_class_init(GstTactileSoundTestSrcClass *klass)
{
  auto *object_class = G_OBJECT_CLASS(klass);
  auto *element_class = GST_ELEMENT_CLASS(klass);
  auto *base_class = GST_BASE_SRC_CLASS(klass);

  object_class->finalize = gst_tactile_sound_test_src_finalize;
  properties::install<SoundSettings>(object_class, kProperties,
                                     { gst_tactile_sound_test_src_settings });
  base_class->fixate = GST_DEBUG_FUNCPTR(gst_tactile_sound_test_src_fixate);
  base_class->set_caps = GST_DEBUG_FUNCPTR(gst_tactile_sound_test_src_set_caps);
  base_class->start = GST_DEBUG_FUNCPTR(gst_tactile_sound_test_src_start);
  base_class->stop = GST_DEBUG_FUNCPTR(gst_tactile_sound_test_src_stop);
  base_class->is_seekable = GST_DEBUG_FUNCPTR(gst_tactile_sound_test_src_is_seekable);
  base_class->do_seek = GST_DEBUG_FUNCPTR(gst_tactile_sound_test_src_do_seek);
  GST_PUSH_SRC_CLASS(klass)->create = gst_tactile_sound_test_src_create;
  gst_element_class_add_static_pad_template(element_class, &src_template);
  gst_element_class_set_static_metadata(element_class, "Tactile sound test source", "Source/Audio",
                                        "Makes impacts, explosions, rumble and music, with ground "
                                        "truth",
                                        "The visuotactile authors");
}

static void
gst_tactile_sound_test_src_init(GstTactileSoundTestSrc *self)
{
  self->priv = new Private;
  gst_audio_info_init(&self->priv->info);
  gst_base_src_set_format(GST_BASE_SRC(self), GST_FORMAT_TIME);
}
