// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Whole measurements of simulated chairs.
#include "calibration/alignment.h"
#include "calibration/rise_time_fit.h"
#include "support/measured_chair.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "support/tolerance.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;

namespace {

double
to_ms(Time time)
{
  return static_cast<double>(time.count()) / 1e6;
}

} // namespace

// The paper's motor, recorded with noise: the calibration recovers Eq. 1, latency, start and hold
// voltage and fall time.
CHECK_TEST(papers_motor_is_recovered)
{
  const MotorParameters motor{ .hold_volts = 0.3, .latency = 8ms };
  std::vector<StepResponse> responses
      = measure({ .repetitions = 2 }, { motor }, { .noise = 0.003 });
  const Calibration calibration = calibrate(responses);
  const TactorCalibration &tactor = calibration.tactors.at(0);
  fail_unless_near(tactor.start_volts, 0.5, 1e-9);
  fail_unless_near(tactor.hold_volts, 0.3, 1e-9);
  fail_unless_near(to_ms(*tactor.latency), 8, 3);
  fail_unless_near(to_ms(tactor.fall_time), 30, 5);
  fail_unless(tactor.quadratic.has_value() && tactor.quadratic->r_squared > 0.995);
  for (double start = 0; start <= 2; start += 0.5)
    for (double target = start + 1; target <= 3; target += 0.5)
      fail_unless_near((*tactor.quadratic)(start, target - start) + to_ms(*tactor.latency),
                       rise_time_quadratic_ms(start, target - start) + 8, 4);
  // Eq. 1 is not monotonic, so the table cannot represent it.
  fail_unless(tactor.prefers_quadratic);
  fail_unless(tactor.vibration.size() >= 10);
  for (const VibrationPoint &point : tactor.vibration)
    fail_unless_near(point.amplitude, 0.25 * point.volts, 0.01 * point.volts);
}

// A command got lost, and a motor was touched: both steps are named and have no effect on the
// result.
CHECK_TEST(contradicted_steps_are_named_and_left_out)
{
  const std::vector<MotorParameters> motors{ { .latency = 5ms } };
  std::vector<StepResponse> responses = measure({ .repetitions = 3 }, motors, { .noise = 0.002 });
  std::vector<StepResponse> untouched = responses;
  const auto strong = std::ranges::find_if(responses, [](const StepResponse &response) {
    return response.step.start_volts == 0 && response.step.target_volts == 2.5;
  });
  strong->fault = StepFault::no_motion;
  const auto touched = std::ranges::find_if(responses, [](const StepResponse &response) {
    return response.step.start_volts == 1 && response.step.target_volts == 3;
  });
  touched->risen_ms += 60;
  const Step lost = strong->step;
  const Step slow = touched->step;
  const Calibration with = calibrate(responses);
  const Calibration without = calibrate(untouched);
  int named = 0;
  for (const StepResponse &response : responses) {
    if (response.step.at == lost.at && response.step.target_volts == lost.target_volts
        && response.fault == StepFault::missed)
      named++;
    if (response.step.at == slow.at && response.step.target_volts == slow.target_volts
        && response.fault == StepFault::outlier)
      named++;
  }
  fail_unless(named == 2, "%d of 2 steps are named", named);
  fail_unless(with.tactors.at(0).steps_refused == without.tactors.at(0).steps_refused + 2);
  fail_unless_near(with.tactors.at(0).quadratic->coefficients[0],
                   without.tactors.at(0).quadratic->coefficients[0], 2);
  fail_unless(with.tactors.at(0).start_volts == without.tactors.at(0).start_volts);
}

// A phone's recording, started by hand some time before.
CHECK_TEST(recordings_without_a_common_clock_are_aligned_by_their_sound)
{
  const std::vector<MotorParameters> motors{ { .latency = 5ms } };
  const MeasurementRun run = plan_measurement({})->at(1);
  const std::vector<IssuedCommand> trace = trace_of(run);
  Recording recording = hear(trace, motors, { .noise = 0.01 }, length_of(run));
  recording.channels[0].insert(recording.channels[0].begin(), 8 * 4321, 0.0);
  recording.start = 17s; // whatever its clock says
  const Time start = align(recording, trace, { 15, 160 });
  fail_unless_near(to_ms(start), -4321, 100);
  // A recording that was started too late.
  recording = hear(trace, motors, { .noise = 0.01 }, length_of(run));
  recording.channels[0].erase(recording.channels[0].begin(),
                              recording.channels[0].begin() + 8 * 3000);
  fail_unless_near(to_ms(align(recording, trace, { 15, 160 })), 3000, 100);
}

// Within any minute no tactor is on for longer, or for a larger share of time, than tactorsink's
// limits allow.
CHECK_TEST(plans_keep_limits)
{
  for (const std::vector<int> &tactors : { std::vector<int>{ 0 }, { 0, 1 }, { 3, 1, 8 } })
    for (const double step : { 0.25, 0.5 }) {
      const auto runs
          = *plan_measurement({ .tactors = tactors, .step_volts = step, .repetitions = 2 });
      for (const MeasurementRun &run : runs) {
        fail_unless(run.front().volts == 0 && run.back().volts == 0);
        fail_unless(length_of(run) < 40s);
        for (const int tactor : tactors) {
          Time on{ 0 };
          Time stretch{ 0 };
          for (const MeasurementStretch &part : run) {
            const bool is_on = part.tactor == tactor && part.volts > 0;
            stretch = is_on ? stretch + part.duration : Time(0);
            on += is_on ? part.duration : Time(0);
            fail_unless(stretch <= 1500ms);
            fail_unless(part.volts <= 3.0);
          }
          fail_unless(to_ms(on) <= 0.36 * to_ms(length_of(run)) + 1500);
        }
      }
    }
}

CHECK_TEST(invalid_plans_are_refused)
{
  const std::vector<MeasurementSettings> senseless{
    { .tactors = {} },   { .tactors = { -1 } }, { .volts_max = 0 },   { .volts_max = 100 },
    { .step_volts = 0 }, { .step_volts = NAN }, { .repetitions = 0 }, { .max_duty = 0.9 },
  };
  for (const MeasurementSettings &settings : senseless)
    fail_if(plan_measurement(settings));
}

CHECK_MAIN(tactor_calibration)
