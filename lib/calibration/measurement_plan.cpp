// SPDX-License-Identifier: LGPL-2.1-or-later
#include "calibration/measurement_plan.h"

#include "tactor/rise_time.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace tactor {

namespace {

constexpr Time kHold = std::chrono::milliseconds(600);   ///< at the start voltage
constexpr Time kTarget = std::chrono::milliseconds(900); ///< at the target
constexpr Time kRest = std::chrono::milliseconds(700);   ///< at least, to measure the noise
constexpr Time kRunLength = std::chrono::seconds(30);
constexpr double kMostVolts = 24;
constexpr double kFromVolts = 1.5; ///< voltage at which any motor turns
constexpr double kLeftToRise = 0.8;
constexpr std::size_t kMostSteps = 1'000'000; ///< for one tactor: a month

struct VoltageStep
{
  double start = 0;
  double target = 0;
};

std::vector<VoltageStep>
voltage_steps(const MeasurementSettings &settings)
{
  std::vector<VoltageStep> steps;
  for (int tenth = 2; tenth <= 10 && 0.1 * tenth < settings.volts_max; tenth++)
    steps.push_back({ 0, 0.1 * tenth });
  for (int tenth = 9; tenth >= 2 && kFromVolts <= settings.volts_max; tenth--)
    steps.push_back({ kFromVolts, 0.1 * tenth });
  const int points = static_cast<int>(std::floor(settings.volts_max / settings.step_volts + 1e-9));
  for (int i = 0; i <= points; i++)
    for (int j = i + 1; j <= points; j++) {
      const VoltageStep step{ i * settings.step_volts, j * settings.step_volts };
      const bool starts = step.start == 0 || step.start >= kStartVolts - 1e-9;
      // Steps from rest up to 1 V are already included.
      const bool is_new = step.start > 0 || step.target > 1.0 + 1e-9;
      if (starts && is_new && step.start <= kLeftToRise * step.target)
        steps.push_back(step);
    }
  return steps;
}

/// Why the settings are invalid; empty if they are valid.
std::string
fault_of(const MeasurementSettings &settings)
{
  const auto got = [](double value) {
    return ", got " + std::to_string(value);
  };
  if (!(settings.volts_max >= 0.6 && settings.volts_max <= kMostVolts))
    return "expected 0.6 to 24 V at most" + got(settings.volts_max);
  if (!(settings.step_volts >= 0.05 && settings.step_volts <= settings.volts_max))
    return "expected steps of 0.05 V up to the greatest voltage" + got(settings.step_volts);
  if (settings.repetitions < 1 || settings.repetitions > 100)
    return "expected 1 to 100 repetitions" + got(settings.repetitions);
  if (!(settings.max_duty > 0 && settings.max_duty <= 0.4))
    return "expected a duty of at most 0.4" + got(settings.max_duty);
  if (settings.tactors.empty())
    return "expected at least one tactor";
  for (const int tactor : settings.tactors)
    if (tactor < 0 || tactor >= 4096)
      return "expected tactors from 0 to 4095" + got(tactor);
  return {};
}

} // namespace

tl::expected<std::vector<MeasurementRun>, std::string>
plan_measurement(const MeasurementSettings &settings)
{
  if (std::string fault = fault_of(settings); !fault.empty())
    return tl::unexpected(std::move(fault));
  const std::vector<VoltageStep> steps = voltage_steps(settings);
  const std::size_t count
      = steps.size() * settings.tactors.size() * static_cast<std::size_t>(settings.repetitions);
  if (count > kMostSteps)
    return tl::unexpected("expected at most " + std::to_string(kMostSteps)
                          + " steps to measure, got " + std::to_string(count));
  std::vector<MeasurementRun> runs;
  MeasurementRun run;
  Time now{ 0 };
  const auto add = [&](int tactor, double volts, Time duration) {
    run.push_back({ .begin = now, .duration = duration, .tactor = tactor, .volts = volts });
    now += duration;
  };
  const auto finish = [&] {
    if (!run.empty())
      runs.push_back(std::move(run));
    run = {};
    now = Time(0);
  };
  for (int repetition = 0; repetition < settings.repetitions; repetition++)
    for (const VoltageStep &step : steps)
      for (const int tactor : settings.tactors) {
        if (now == Time(0))
          add(tactor, 0, kRest);
        const Time on = kTarget + (step.start > 0 ? kHold : Time(0));
        if (step.start > 0)
          add(tactor, step.start, kHold);
        add(tactor, step.target, kTarget);
        // The other tactors take their turns while one rests.
        const double cycle = static_cast<double>(on.count()) / settings.max_duty
                             / static_cast<double>(settings.tactors.size());
        add(tactor, 0, std::max(kRest, Time(std::llround(cycle)) - on));
        if (now >= kRunLength)
          finish();
      }
  finish();
  return runs;
}

Time
length_of(const MeasurementRun &run)
{
  return run.empty() ? Time(0) : run.back().begin + run.back().duration;
}

} // namespace tactor
