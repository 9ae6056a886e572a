// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "calibration/recording.h"
#include "calibration/simulated_sensor.h"
#include "tactor/command_trace.h"
#include "tactor/motor_model.h"

#include <atomic>
#include <string>
#include <vector>

/// Levels of all tactors for some time.
struct Frame
{
  tactor::Time begin{ 0 };
  tactor::Time duration{ 0 };
  std::vector<float> levels{}; ///< by tactor, as many in all frames
};

/// How frames are played and recorded.
struct PlayerSettings
{
  std::string driver = "auto"; ///< tactorsink's, like the next two; or kAudio, with a card's name
  std::string device{};
  double volts_max = 3.0;
  int channels = 2;          ///< of the sound card
  std::string frequency{};   ///< of the carriers on it
  bool compensate = false;   ///< whether commands precede their frames by the rise time
  std::string calibration{}; ///< key file for tactorsink; empty: none
  /// A launch line of a GStreamer audio source; "simulator": motors are simulated and recorded;
  /// empty: nothing is recorded.
  std::string source{};
  std::vector<tactor::MotorParameters> motors{}; ///< simulated ones
  tactor::SimulatedSensor sensor{};              ///< that records them
};

/// Trace and recording of a play, on the same running time.
struct Played
{
  std::vector<tactor::IssuedCommand> trace{};
  tactor::Recording recording{};
};

/// Plays frames on tactorsink or a sound card and records at the same time, in one pipeline with
/// one clock; simulated motors are played faster than real time. Ends when `interrupted` becomes
/// true. All motors are at zero when this returns or throws std::runtime_error.
Played play(const std::vector<Frame> &frames, const PlayerSettings &settings,
            const std::atomic<bool> &interrupted);
