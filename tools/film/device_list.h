// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "pipeline.h"

#include "chair/settings.h"

#include <gst/gst.h>

#include <functional>
#include <string>
#include <vector>

/// The driver of programs for shakers at a sound card. All others are tactorsink's.
inline constexpr const char *kAudio = chair::kShakers;

/// Calls `with` for each device of a class. The devices are only listed, not opened.
void for_each_device(const char *classes, const std::function<void(GstDevice *)> &with);

/// A device that is connected, by the names of programs' options.
struct FoundDevice
{
  std::string name; ///< for people
  std::string driver;
  std::string device;
  std::string bus_path{}; ///< of a board: "1-2.3"
};

/// Boards and gamepads, then sound cards. They are only listed, not opened.
std::vector<FoundDevice> found_devices();

/// Empty if it is not set.
std::string text_property(gpointer object, const char *name);

/// Whether an open sink's driver is the simulator. Throws std::runtime_error with `told`, the
/// sink's last message, if it is not, but the motors are simulated as there is no board.
bool is_simulated(GstElement *sink, const std::string &told);

/// A new element that plays on the device; null if there can be none.
Owned<GstElement> element_of(GstDevice *device);

/// The audio sink of the sound card of this name, as on a launch line. Throws std::runtime_error if
/// there is none.
std::string audio_sink(const std::string &card);
