// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "../properties.h"
#include "synth/carriers.h"
#include "synth/shaker.h"
#include "tactor/motor_limits.h"

#include <gst/gst.h>

#include <map>
#include <string>
#include <vector>

/// The properties of tactilesynth. Not thread-safe.
struct SynthSettings
{
  static constexpr int kMostChannels = 64;

  synth::Carriers carriers;
  std::vector<std::string> samples = { "" }; ///< files of Waveform::sample, by entry_of()
  std::vector<int> mapping;                  ///< empty: by channels and their positions
  std::map<std::string, std::string> faults; ///< properties whose last text was refused, and why

  synth::Time rise_time = synth::kShakerRise;
  std::string calibration; ///< key file; empty: none
  double volts_max = 3;
  std::string trace_location; ///< empty: no trace

  double rate = 0;
  double intensity = 1;
  bool mute = false;
  tactor::MotorLimits limits;
  synth::Time ramp_in = std::chrono::milliseconds(100);

  /// Whether nothing is to be felt, whatever the maps are.
  bool is_silent() const
  {
    return mute || intensity <= 0;
  }

  /// All properties of tactilesynth, in order.
  static std::span<const properties::Property<SynthSettings>> table();
};
