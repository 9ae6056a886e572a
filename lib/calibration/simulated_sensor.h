// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "calibration/recording.h"
#include "tactor/command_trace.h"
#include "tactor/motor_model.h"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace tactor {

/// A simulated sensor on simulated motors, with disturbances. Amplitudes are in the recording's
/// unit, where 1 is full scale.
struct SimulatedSensor
{
  double rate = 8000;          ///< samples per second
  double gain = 0.25;          ///< amplitude per volt of MotorModel::amplitude()
  std::vector<double> gains{}; ///< factor per tactor; 1 if missing
  bool separate = false;       ///< a channel per tactor instead of one for all
  double slowest_hz = 25;      ///< vibration frequency of an eccentric mass at 0 V…
  double hz_per_volt = 17.3;   ///< …and its increase per volt: the paper's 77 Hz at 3 V
  double noise = 0;            ///< RMS of white noise
  double hum = 0;              ///< amplitude of mains hum; its third harmonic has a third of it
  double hum_hz = 50;
  double drift = 0; ///< per second
  double clip = 0;  ///< range limit of the sensor; 0: none
  /// Normalized shape of a rise over time: from 0 at 0 towards 1, never falling, in any unit of
  /// time. It is stretched to reach 90 % when MotorModel does. Empty: MotorModel's exponential.
  std::function<double(double)> growth{};
  Time jitter{ 0 }; ///< largest extra delay of a command, uniformly distributed
  std::uint32_t seed = 1;
};

/// Simulates a recording of motors driven by `trace`, from running time 0 to `end`. Tactor i has
/// motors[i], with its latency; missing ones have the paper's parameters.
Recording hear(std::span<const IssuedCommand> trace, std::span<const MotorParameters> motors,
               const SimulatedSensor &sensor, Time end);

} // namespace tactor
