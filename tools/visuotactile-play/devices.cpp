// SPDX-License-Identifier: LGPL-2.1-or-later
#include "devices.h"

#include "film/command_line.h"
#include "tactor/drivers/registry.h"

#include <gst/gst.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <stdexcept>
#include <vector>

namespace {

/// Calls `with` for each device of a class. The devices are only listed, not opened.
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

std::string
text_property(gpointer object, const char *name)
{
  g_autofree gchar *text = nullptr;
  g_object_get(object, name, &text, nullptr);
  return text ? text : "";
}

/// A new element that plays on the device.
Owned<GstElement>
element_of(GstDevice *device)
{
  GstElement *made = gst_device_create_element(device, nullptr);
  return Owned<GstElement>(made ? GST_ELEMENT(gst_object_ref_sink(made)) : nullptr);
}

/// The audio sink of a sound card, as on a launch line.
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
    // By what the sinks of PulseAudio, ALSA and PipeWire name their device.
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
    throw std::runtime_error("expected --device to name a sound card, got '" + card + "'; found "
                             + (cards.empty() ? "none" : cards));
  return line;
}

void
print(const std::string &options, const std::string &name)
{
  std::printf("  %-48s %s\n", options.c_str(), name.c_str());
}

std::string
shell_word(const std::string &text)
{
  const auto is_plain = [](char c) {
    return g_ascii_isalnum(c) || std::string_view("_-./:%=,@").find(c) != std::string_view::npos;
  };
  if (std::ranges::all_of(text, is_plain))
    return text;
  g_autofree gchar *quoted = g_shell_quote(text.c_str());
  return quoted;
}

} // namespace

void
check(const ChosenDevice &chosen)
{
  std::string known;
  for (const tactor::DriverInfo &driver : tactor::drivers()) {
    if (driver.name == chosen.driver)
      return;
    known += std::string(driver.name) + ", ";
  }
  if (chosen.driver != kAudio)
    throw UsageError("--driver is one of " + known + kAudio + ", got '" + chosen.driver + "'");
}

std::string
sink_line(const ChosenDevice &chosen)
{
  std::string line = chosen.element();
  if (chosen.driver != kAudio) {
    if (chosen.driver != "auto")
      line += " driver=" + chosen.driver;
    return chosen.device.empty() ? line : line + " device=" + launch_value(chosen.device);
  }
  if (chosen.channels != 2)
    line += " channels=" + std::to_string(chosen.channels);
  return chosen.device.empty() ? line
                               : line + " audio-sink=" + launch_value(audio_sink(chosen.device));
}

Owned<GstElement>
make_sink(const std::string &line)
{
  g_autoptr(GError) error = nullptr;
  GstElement *sink
      = gst_parse_launch_full(line.c_str(), nullptr, GST_PARSE_FLAG_FATAL_ERRORS, &error);
  if (sink == nullptr)
    throw std::runtime_error(error->message);
  return Owned<GstElement>(GST_ELEMENT(gst_object_ref_sink(sink)));
}

MotorWalk
motors_of(const ChosenDevice &chosen, unsigned rows, unsigned columns)
{
  if (chosen.driver != kAudio)
    return walk_of_device(chosen.driver, chosen.device, rows, columns);
  std::vector<std::string> names;
  for (unsigned channel = 1; channel <= chosen.channels; channel++)
    names.push_back("channel " + std::to_string(channel));
  return walk_of_motors(names);
}

int
list_devices()
{
  std::puts("Found:");
  bool found = false;
  for_each_device("Sink/Tactile", [&](GstDevice *device) {
    const Owned<GstElement> sink = element_of(device);
    if (sink == nullptr)
      return;
    found = true;
    print("--driver=" + text_property(sink.get(), "driver") + " "
              + shell_word("--device=" + text_property(sink.get(), "device")),
          text_property(device, "display-name"));
  });
  for_each_device("Audio/Sink", [&](GstDevice *device) {
    found = true;
    const std::string name = text_property(device, "display-name");
    print("--driver=audio " + shell_word("--device=" + name), "shakers at a sound card");
  });
  if (!found)
    print("nothing", "no board, gamepad or sound card");
  std::puts("\nNot looked for, as that would disturb them:");
  for (const tactor::DriverInfo &driver : tactor::drivers()) {
    if (driver.name == "bhaptics")
      print("--driver=bhaptics --device=vest-back", "or another part of a suit, or PART@HOST");
    if (driver.name == "intiface")
      print("--driver=intiface --device=NAME", "as Intiface shows it, or NAME@HOST");
  }
  std::puts("\nAlways there:");
  print("--driver=audio", "the desktop's sound card");
  print("--driver=simulator", "no hardware");
  return 0;
}
