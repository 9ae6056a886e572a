// SPDX-License-Identifier: LGPL-2.1-or-later
//
// How exactly is a rise time measured through noise? Simulated motors with the paper's rise times, white noise between 0 and 4 kHz, a
// line for each 3 dB between the steady vibration of a step and the noise: errors of single steps, and of the median of nine. Usage:
// rise_time_accuracy
#include "tactor/calibration/median.h"
#include "tests/check/libs/measured_chair.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

using namespace tactor;

namespace {

double
truth_ms(const Step &step, const MotorParameters &motor)
{
  const Time rise = motor.rise_time(step.start_volts, step.target_volts);
  return static_cast<double>((rise + *motor.latency).count()) / 1e6;
}

double
at(std::vector<double> errors, double share)
{
  std::ranges::sort(errors);
  return errors[static_cast<std::size_t>(share * static_cast<double>(errors.size() - 1))];
}

} // namespace

int
main()
{
  const MotorParameters motor{ .latency = std::chrono::milliseconds(8) };
  std::map<int, std::vector<double>> single;
  std::map<int, std::vector<double>> of_nine;
  for (int decibels = 10; decibels <= 40; decibels += 5) {
    SimulatedSensor sensor{ .seed = static_cast<std::uint32_t>(1000 * decibels) };
    sensor.noise = sensor.gain * 3 / std::sqrt(2.0) * std::pow(10, -decibels / 20.0);
    std::map<std::pair<double, double>, std::vector<double>> repeated;
    for (const StepResponse &response : measure({ .repetitions = 9 }, { motor }, sensor)) {
      if (response.fault != StepFault::none || !response.step.rises())
        continue;
      const double error = response.risen_ms - truth_ms(response.step, motor);
      repeated[{ response.step.start_volts, response.step.target_volts }].push_back(error);
    }
    for (const auto &[volts, errors] : repeated) {
      const double own = decibels + 20 * std::log10(volts.second / 3);
      const int bin = static_cast<int>(std::floor(own / 3)) * 3;
      for (const double error : errors)
        single[bin].push_back(std::abs(error));
      if (errors.size() >= 9)
        of_nine[bin].push_back(std::abs(median({ errors.begin(), errors.begin() + 9 })));
    }
  }
  std::printf("signal to noise   single: n  p50  p95 ms   median of nine: n  p50  p95 ms\n");
  for (const auto &[bin, errors] : single) {
    std::printf("%3d to %3d dB  %12zu %5.1f %5.1f", bin, bin + 3, errors.size(), at(errors, 0.5),
                at(errors, 0.95));
    if (of_nine.contains(bin))
      std::printf("  %18zu %5.1f %5.1f", of_nine[bin].size(), at(of_nine[bin], 0.5),
                  at(of_nine[bin], 0.95));
    std::printf("\n");
  }
  return 0;
}
