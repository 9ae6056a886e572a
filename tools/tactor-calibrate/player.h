// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "calibration/recording.h"
#include "calibration/simulated_sensor.h"
#include "tactor/command_trace.h"
#include "tactor/motor_model.h"

#include <atomic>
#include <string>
#include <vector>

/// What all tactors are told for a while.
struct Frame
{
  tactor::Time begin{ 0 };
  tactor::Time duration{ 0 };
  std::vector<float> levels{}; ///< by tactor, as many in all frames
};

/// How frames are played and heard.
struct PlayerSettings
{
  std::string driver = "auto"; ///< as tactorsink's
  std::string device{};
  double volts_max = 3.0;
  bool compensate
      = false; ///< commands come early by the motors' rise times, else with their frames
  std::string calibration{}; ///< key file for tactorsink; empty: none
  /// A launch line of a GStreamer audio source; "simulator": motors are simulated, and heard;
  /// empty: nothing is recorded.
  std::string source{};
  std::vector<tactor::MotorParameters> motors{}; ///< that are simulated
  tactor::SimulatedSensor sensor{};              ///< that hears them
};

/// What was played and heard. The recording's running time is the trace's.
struct Played
{
  std::vector<tactor::IssuedCommand> trace{};
  tactor::Recording recording{};
};

/// Plays frames by tactorsink and records at the same time, in one pipeline with one clock.
/// Simulated motors wait for no clock: what they are told is heard at once. When this returns or
/// throws, and whenever `interrupted` becomes true, which ends the play, all motors are at zero.
/// Throws std::runtime_error with what went wrong.
Played play(const std::vector<Frame> &frames, const PlayerSettings &settings,
            const std::atomic<bool> &interrupted);
