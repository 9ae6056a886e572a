// SPDX-License-Identifier: LGPL-2.1-or-later
//
// simulatedshaker: what an amplifier drives. Sound in, vibration out: a resonator of frequency f
// and quality Q, whose amplitude approaches that of the sound by exp(-pi f t / Q).
#include <gst/audio/audio.h>
#include <gst/audio/gstaudiofilter.h>

#include <cmath>
#include <numbers>

struct SimulatedShaker
{
  GstAudioFilter parent;
  gdouble frequency;
  gdouble quality;
  gdouble last[2]; ///< samples of the output
};

struct SimulatedShakerClass
{
  GstAudioFilterClass parent_class;
};

G_DEFINE_TYPE(SimulatedShaker, simulated_shaker, GST_TYPE_AUDIO_FILTER)

static GstFlowReturn
simulated_shaker_transform_ip(GstBaseTransform *base, GstBuffer *buffer)
{
  auto *self = reinterpret_cast<SimulatedShaker *>(base);
  const gint rate = GST_AUDIO_FILTER_RATE(self);
  const double omega = 2 * std::numbers::pi * self->frequency / rate;
  const double r = std::exp(-std::numbers::pi * self->frequency / (self->quality * rate));
  // Of a sound at its frequency, the steady output has the input's amplitude.
  const double gain = (1 - r) * std::sqrt(1 - 2 * r * std::cos(2 * omega) + r * r);
  GstMapInfo map;
  gst_buffer_map(buffer, &map, GST_MAP_READWRITE);
  auto *samples = reinterpret_cast<gdouble *>(map.data);
  for (gsize i = 0; i < map.size / sizeof(gdouble); i++) {
    const double moved
        = gain * samples[i] + 2 * r * std::cos(omega) * self->last[0] - r * r * self->last[1];
    self->last[1] = self->last[0];
    self->last[0] = samples[i] = moved;
  }
  gst_buffer_unmap(buffer, &map);
  return GST_FLOW_OK;
}

static void
simulated_shaker_set_property(GObject *object, guint id, const GValue *value, GParamSpec *)
{
  auto *self = reinterpret_cast<SimulatedShaker *>(object);
  (id == 1 ? self->frequency : self->quality) = g_value_get_double(value);
}

static void
simulated_shaker_init(SimulatedShaker *self)
{
  self->frequency = 60;
  self->quality = 2;
}

static void
simulated_shaker_class_init(SimulatedShakerClass *klass)
{
  auto *object = G_OBJECT_CLASS(klass);
  constexpr auto kFlags = static_cast<GParamFlags>(G_PARAM_WRITABLE | G_PARAM_STATIC_STRINGS);
  object->set_property = simulated_shaker_set_property;
  g_object_class_install_property(
      object, 1, g_param_spec_double("frequency", nullptr, "Its resonance", 1, 1000, 60, kFlags));
  g_object_class_install_property(
      object, 2, g_param_spec_double("quality", nullptr, "Its quality", 0.5, 100, 2, kFlags));
  gst_element_class_set_static_metadata(GST_ELEMENT_CLASS(klass), "Simulated shaker",
                                        "Filter/Audio", "Vibrates as the sound drives it",
                                        "visuotactile");
  g_autoptr(GstCaps) caps = gst_caps_from_string("audio/x-raw, format=F64LE, layout=interleaved, "
                                                 "rate=[8000,192000], channels=1");
  gst_audio_filter_class_add_pad_templates(GST_AUDIO_FILTER_CLASS(klass), caps);
  GST_BASE_TRANSFORM_CLASS(klass)->transform_ip = simulated_shaker_transform_ip;
}

static gboolean
plugin_init(GstPlugin *plugin)
{
  return gst_element_register(plugin, "simulatedshaker", GST_RANK_NONE,
                              simulated_shaker_get_type());
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, simulatedshaker,
                  "Vibrates as sound drives it; for tests", plugin_init, PACKAGE_VERSION, "LGPL",
                  PACKAGE_NAME, PACKAGE_ORIGIN)
