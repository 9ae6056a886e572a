// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/device_list.h"
#include "film/motor_walk.h"
#include "film/pipeline.h"

#include <string>

/// The device of the command line.
struct ChosenDevice
{
  std::string driver;
  std::string device;    ///< of tactorsink, or a sound card's name; may be empty
  unsigned channels = 2; ///< of the sound card

  /// The sink element for it.
  const char *element() const
  {
    return driver == kAudio ? "tactoraudiosink" : "tactorsink";
  }
};

/// The sink as on a launch line. Throws std::runtime_error if there is no such sound card.
std::string sink_line(const ChosenDevice &chosen);

/// A sink of that line. Throws std::runtime_error.
Owned<GstElement> make_sink(const std::string &line);

/// The motors of the feel test: those that the device knows, the channels of a sound card, else the
/// cells of a grid. Throws std::runtime_error.
MotorWalk motors_of(const ChosenDevice &chosen, unsigned rows, unsigned columns);

/// Prints boards, gamepads and sound cards, and the names for other devices. Opens none. Returns
/// the exit status.
int list_devices();
