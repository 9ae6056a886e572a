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

/// A sensor at simulated motors, and what disturbs it. Amplitudes in the recording's unit, full
/// scale being 1.
struct SimulatedSensor
{
  double rate = 8000;          ///< samples per second
  double gain = 0.25;          ///< amplitude per volt of MotorModel::amplitude()
  std::vector<double> gains{}; ///< of each tactor, a factor; 1 where there is none
  bool separate = false;       ///< a channel for each tactor rather than one for all
  double slowest_hz
      = 25; ///< an eccentric mass turns the faster the stronger it is driven: this at 0 V…
  double hz_per_volt = 17.3; ///< …and so much more with each volt: the paper's 77 Hz at 3 V
  double noise = 0;          ///< RMS of white noise
  double hum = 0; ///< amplitude of mains hum, with a third of it at three times the frequency
  double hum_hz = 50;
  double drift = 0; ///< per second
  double clip = 0;  ///< where the sensor's range ends; 0: nowhere
  /// The share of a rise that is done after a time, in any unit: from 0 at 0 towards 1, never
  /// falling. It is stretched so that the 90 % are where MotorModel has them. Empty: MotorModel's
  /// exponential.
  std::function<double(double)> growth{};
  Time jitter{ 0 }; ///< each command takes up to so much longer, evenly spread
  std::uint32_t seed = 1;
};

/// What the sensor hears while motors are told `trace`, from running time 0 to `end`. Tactor i has
/// motors[i], with its latency; those beyond have the paper's.
Recording hear(std::span<const IssuedCommand> trace, std::span<const MotorParameters> motors,
               const SimulatedSensor &sensor, Time end);

} // namespace tactor
