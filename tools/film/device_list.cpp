// SPDX-License-Identifier: LGPL-2.1-or-later
#include "device_list.h"

#include "command_line.h"
#include "translation.h"

#include <stdexcept>

void
for_each_device(const char *classes, const std::function<void(GstDevice *)> &with)
{
  const Owned<GstDeviceMonitor> monitor(gst_device_monitor_new());
  gst_device_monitor_add_filter(monitor.get(), classes, nullptr);
  // Where no provider can be started, there is no device.
  const bool started = gst_device_monitor_start(monitor.get());
  GList *devices = gst_device_monitor_get_devices(monitor.get());
  for (const GList *item = devices; item != nullptr; item = item->next)
    with(GST_DEVICE(item->data));
  g_list_free_full(devices, gst_object_unref);
  if (started)
    gst_device_monitor_stop(monitor.get());
}

std::vector<FoundDevice>
found_devices()
{
  std::vector<FoundDevice> found;
  for_each_device("Sink/Tactile", [&](GstDevice *device) {
    const Owned<GstElement> sink = element_of(device);
    if (sink == nullptr)
      return;
    g_autoptr(GstStructure) properties = gst_device_get_properties(device);
    const char *bus_path
        = properties ? gst_structure_get_string(properties, "device.bus_path") : nullptr;
    found.push_back({ .name = text_property(device, "display-name"),
                      .driver = text_property(sink.get(), "driver"),
                      .device = text_property(sink.get(), "device"),
                      .bus_path = bus_path ? bus_path : "" });
  });
  for_each_device("Audio/Sink", [&](GstDevice *device) {
    const std::string name = text_property(device, "display-name");
    found.push_back({ .name = name, .driver = kAudio, .device = name });
  });
  return found;
}

std::string
text_property(gpointer object, const char *name)
{
  g_autofree gchar *text = nullptr;
  g_object_get(object, name, &text, nullptr);
  return text ? text : "";
}

bool
is_simulated(GstElement *sink, const std::string &told)
{
  if (g_object_class_find_property(G_OBJECT_GET_CLASS(sink), "actuation-stats") == nullptr)
    return false; // shakers
  g_autoptr(GstStructure) stats = nullptr;
  g_object_get(sink, "actuation-stats", &stats, nullptr);
  if (g_strcmp0(gst_structure_get_string(stats, "board"), "simulator") != 0)
    return false;
  if (text_property(sink, "driver") != "simulator")
    throw std::runtime_error(told.empty() ? "the motors are simulated" : told);
  return true;
}

Owned<GstElement>
element_of(GstDevice *device)
{
  GstElement *made = gst_device_create_element(device, nullptr);
  return Owned<GstElement>(made ? GST_ELEMENT(gst_object_ref_sink(made)) : nullptr);
}

std::string
audio_sink(const std::string &card)
{
  std::string line;
  std::string cards;
  for_each_device("Audio/Sink", [&](GstDevice *device) {
    const std::string name = text_property(device, "display-name");
    cards += (cards.empty() ? "'" : ", '") + name + "'";
    const Owned<GstElement> sink = name == card && line.empty() ? element_of(device) : nullptr;
    if (sink == nullptr)
      return;
    line = GST_OBJECT_NAME(gst_element_get_factory(sink.get()));
    // The properties by which the sinks of PulseAudio, ALSA and PipeWire name their device.
    for (const char *property : { "device", "target-object" }) {
      const GParamSpec *spec
          = g_object_class_find_property(G_OBJECT_GET_CLASS(sink.get()), property);
      const std::string value
          = spec && spec->value_type == G_TYPE_STRING ? text_property(sink.get(), property) : "";
      if (!value.empty())
        line += std::string(" ") + property + "=" + launch_value(value);
    }
  });
  if (line.empty())
    throw std::runtime_error(in_text("expected --device to name a sound card, got '{}'; found {}",
                                     card, (cards.empty() ? "none" : cards)));
  return line;
}
