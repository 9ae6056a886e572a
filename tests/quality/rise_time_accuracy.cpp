// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Accuracy of measured rise times by signal-to-noise ratio. Simulates motors with the paper's rise
// times and several shapes of rise, with white noise from 0 to 4 kHz. Prints a line per 3 dB of
// SNR: errors of single steps, of the median of nine, and of the first motion of strong rises from
// rest. Then the errors of calibrations that tactor-calibrate makes of its default measurement.
// Usage: rise_time_accuracy [steps|calibrations]
#include "calibration/median.h"
#include "support/measured_chair.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

using namespace tactor;

namespace {

constexpr int kRepetitions = 9;

struct Errors
{
  std::vector<double> single{};
  std::vector<double> of_nine{};
  std::vector<double> onset{};
  double in_band_db = 0; ///< summed
};

double
truth_ms(const Step &step, const MotorParameters &motor)
{
  const Time rise = motor.rise_time(step.start_volts, step.target_volts);
  return static_cast<double>((rise + *motor.latency).count()) / 1e6;
}

double
at(std::vector<double> errors, double share)
{
  if (errors.empty())
    return 0;
  for (double &error : errors)
    error = std::abs(error);
  std::ranges::sort(errors);
  return errors[static_cast<std::size_t>(share * static_cast<double>(errors.size() - 1))];
}

double
mean(const std::vector<double> &errors)
{
  return std::accumulate(errors.begin(), errors.end(), 0.0)
         / static_cast<double>(std::max<std::size_t>(errors.size(), 1));
}

void
add(std::map<int, Errors> &bins, const Growth &growth, int decibels, const MotorParameters &motor)
{
  SimulatedSensor sensor{ .seed = static_cast<std::uint32_t>(1000 * decibels) };
  sensor.noise = sensor.gain * 3 / std::sqrt(2.0) * std::pow(10, -decibels / 20.0);
  if (growth.share)
    sensor.growth = growth.share;
  std::map<std::pair<double, double>, std::vector<double>> repeated;
  for (const StepResponse &response : measure({ .repetitions = kRepetitions }, { motor }, sensor)) {
    const Step &step = response.step;
    if (response.fault != StepFault::none || !step.rises())
      continue;
    const double own = decibels + 20 * std::log10(step.target_volts / 3);
    Errors &bin = bins[static_cast<int>(std::floor(own / 3)) * 3];
    const double error = response.risen_ms - truth_ms(step, motor);
    bin.single.push_back(error);
    bin.in_band_db += response.snr_db;
    if (step.start_volts == 0 && step.target_volts >= 1.5)
      bin.onset.push_back(response.onset_ms - static_cast<double>(motor.latency->count()) / 1e6);
    std::vector<double> &own_errors = repeated[{ step.start_volts, step.target_volts }];
    own_errors.push_back(error);
    if (own_errors.size() == kRepetitions)
      bin.of_nine.push_back(median(own_errors));
  }
}

/// Errors of a calibration for rises to at least 1 V, of four motors: slow and fast, near and far.
std::vector<double>
errors_of_calibrations(const Growth &growth, double decibels, double at_volts, int repetitions)
{
  std::vector<double> errors;
  for (int i = 0; i < 4; i++) {
    RiseTimeTable table{ .size = 31, .milliseconds = {} };
    for (int start = 0; start < 31; start++)
      for (int target = 0; target < 31; target++)
        table.milliseconds.push_back(
            (0.5 + 0.25 * i) * static_cast<double>(RiseTime()(0.1 * start, 0.1 * target).count())
            / 1e6);
    const MotorParameters motor{ .rise_time = RiseTime(table),
                                 .latency = std::chrono::milliseconds(3 + 7 * i) };
    SimulatedSensor sensor{ .seed = static_cast<std::uint32_t>(1000 * i) };
    sensor.noise = sensor.gain * at_volts / std::sqrt(2.0) * std::pow(10, -decibels / 20);
    if (growth.share)
      sensor.growth = growth.share;
    std::vector<StepResponse> responses
        = measure({ .repetitions = repetitions }, { motor }, sensor);
    const Calibration calibration = calibrate(responses);
    const TactorCalibration &found = calibration.tactors.at(0);
    for (double start = 0; start <= 2; start += 0.5)
      for (double target = 1; target <= 3; target += 0.5)
        if (start <= 0.8 * target)
          errors.push_back(
              static_cast<double>((found.rise_time()(start, target) + *found.latency).count()) / 1e6
              - truth_ms({ .start_volts = start, .target_volts = target }, motor));
  }
  return errors;
}

void
print_steps()
{
  const MotorParameters motor{ .latency = std::chrono::milliseconds(8) };
  for (const Growth &growth : kGrowths) {
    std::map<int, Errors> bins;
    for (const int decibels : { 16, 20, 24, 28 })
      add(bins, growth, decibels, motor);
    std::printf("%s\n  signal to noise  in band   single: n  p50  p95  max ms   nine: n  p50  p95 "
                "ms   onset: mean  p95 ms\n",
                growth.name);
    for (const auto &[bin, errors] : bins)
      std::printf("  %4d to %2d dB  %6.0f dB  %8zu %5.1f %5.1f %5.1f  %10zu %5.1f %5.1f  %12.1f "
                  "%5.1f\n",
                  bin, bin + 3, errors.in_band_db / static_cast<double>(errors.single.size()),
                  errors.single.size(), at(errors.single, 0.5), at(errors.single, 0.95),
                  at(errors.single, 1), errors.of_nine.size(), at(errors.of_nine, 0.5),
                  at(errors.of_nine, 0.95), mean(errors.onset), at(errors.onset, 0.95));
    std::fflush(stdout);
  }
}

void
print_calibrations()
{
  std::printf("calibrations; all rises to 1 V and more\n  20 dB at  repetitions  rise     n  p50  "
              "p95  max ms\n");
  for (const double at_volts : { 1.0, 3.0 })
    for (const int repetitions : { 1, 3 })
      for (const Growth &growth : kGrowths) {
        const std::vector<double> errors
            = errors_of_calibrations(growth, 20, at_volts, repetitions);
        std::printf("  %6.1f V  %11d  %-12s %4zu %5.1f %5.1f %5.1f\n", at_volts, repetitions,
                    growth.name, errors.size(), at(errors, 0.5), at(errors, 0.95), at(errors, 1));
        std::fflush(stdout);
      }
}

} // namespace

int
main(int argc, char **argv)
{
  const std::string only = argc > 1 ? argv[1] : "";
  if (only != "calibrations")
    print_steps();
  if (only != "steps")
    print_calibrations();
  return 0;
}
