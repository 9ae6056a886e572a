// SPDX-License-Identifier: LGPL-2.1-or-later
#include "devices.h"

#include "film/command_line.h"
#include "film/device_list.h"
#include "tactor/drivers/registry.h"
#include "translation.h"

#include <gst/gst.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <vector>

namespace {

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
    names.push_back(in_text("channel {}", std::to_string(channel)));
  return walk_of_motors(names);
}

int
list_devices()
{
  std::puts(_("Found:"));
  const std::vector<FoundDevice> found = found_devices();
  for (const FoundDevice &device : found)
    print("--driver=" + device.driver + " " + shell_word("--device=" + device.device),
          device.driver == kAudio ? _("shakers at a sound card") : device.name);
  if (found.empty())
    print(_("nothing"), _("no board, gamepad or sound card"));
  std::puts(_("\nNot looked for, as that would disturb them:"));
  for (const tactor::DriverInfo &driver : tactor::drivers()) {
    if (driver.name == "bhaptics")
      print("--driver=bhaptics --device=vest-back", _("or another part of a suit, or PART@HOST"));
    if (driver.name == "intiface")
      print("--driver=intiface --device=NAME", _("as Intiface shows it, or NAME@HOST"));
  }
  std::puts(_("\nAlways there:"));
  print("--driver=audio", _("the desktop's sound card"));
  print("--driver=simulator", _("no hardware"));
  return 0;
}
