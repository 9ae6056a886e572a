// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "synth/carriers.h"
#include "synthmotors.h"
#include "synthsettings.h"
#include "tactor/command_trace.h"

#include <gst/gst.h>

#include <optional>

/// The files that tactilesynth reads and opens before it plays.
struct SynthParts
{
  synth::Carriers carriers;
  SynthMotors motors;
  std::optional<tactor::CommandTrace> trace; ///< written by the streaming thread

  /// Reads files as the settings say. False after an error message of `element`.
  bool open(GstElement *element, const SynthSettings &settings);
  /// Ends the trace. A warning says if it is incomplete.
  void close(GstElement *element);

private:
  bool read_samples(GstElement *element, const SynthSettings &settings);
};
