// SPDX-License-Identifier: LGPL-2.1-or-later
#include "calibration/calibration.h"

#include "tactor/command_planner.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/temporary_file.h"
#include "support/tolerance.h"
#include "unlimited.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;

namespace {

TactorCalibration
some_tactor()
{
  return { .latency = 12ms,
           .start_volts = 0.6,
           .hold_volts = 0.4,
           .fall_time = 25ms,
           .table = RiseTimeTable{ .step_volts = 1.5,
                                   .size = 3,
                                   .milliseconds = { 90, 80.125, 70, 60, 50, 40, 30, 20, 10 } },
           .quadratic
           = QuadraticRiseTime{ .coefficients = { 241.9, -175.7, -117.7, 38.86, 49.59, 18.07 },
                                .confidence = { 1, 2, 3, 4, 5, 6 },
                                .r_squared = 0.98,
                                .residual_ms = 6.5 },
           .vibration = { { 0.6, 0.1 }, { 1.5, 0.5 }, { 3, 0.8 } },
           .gain_db = -4.5,
           .equalizer = { { 45, -6, 2 }, { 62.5, 3, 0.7 } },
           .steps_used = 40,
           .steps_refused = 2 };
}

std::string
refusal(const std::string &text)
{
  const TemporaryFile file(text);
  const tl::expected<Calibration, std::string> read = read_calibration(file.path);
  if (read)
    return {};
  fail_unless(read.error().find(file.path) != std::string::npos, "%s", read.error().c_str());
  return read.error();
}

void
expect_refusal(const std::string &text, const std::string &says)
{
  const std::string got = refusal(text);
  fail_unless(got.find(says) != std::string::npos, "'%s' instead of '%s' for:\n%s", got.c_str(),
              says.c_str(), text.c_str());
}

} // namespace

CHECK_TEST(file_round_trip)
{
  const TemporaryFile file;
  Calibration written{ .motor = "coin motor; 10 mm, \"C10\"",
                       .date = "2026-11-21T22:00:00Z",
                       .method = "contact microphone",
                       .perception_exponent = 0.8,
                       .tactors = { { 3, some_tactor() }, { 0, {} } } };
  write_calibration(written, file.path);
  const Calibration read = *read_calibration(file.path);
  ck_assert_str_eq(read.motor.c_str(), written.motor.c_str());
  ck_assert_str_eq(read.date.c_str(), written.date.c_str());
  ck_assert_str_eq(read.method.c_str(), written.method.c_str());
  fail_unless(read.perception_exponent == 0.8);
  fail_unless(read.tactors.size() == 2);
  const TactorCalibration &tactor = read.tactors.at(3);
  fail_unless(tactor.latency == Time(12ms) && tactor.fall_time == Time(25ms));
  fail_unless(tactor.start_volts == 0.6 && tactor.hold_volts == 0.4);
  fail_unless(tactor.table->milliseconds == some_tactor().table->milliseconds);
  fail_unless(tactor.table->step_volts == 1.5 && tactor.table->size == 3);
  fail_unless(tactor.quadratic->coefficients == some_tactor().quadratic->coefficients);
  fail_unless(tactor.quadratic->confidence == some_tactor().quadratic->confidence);
  fail_unless(tactor.quadratic->r_squared == 0.98 && tactor.quadratic->residual_ms == 6.5);
  fail_unless(tactor.vibration.size() == 3 && tactor.vibration[1].amplitude == 0.5);
  fail_if(tactor.prefers_quadratic);
  fail_unless(tactor.steps_used == 40 && tactor.steps_refused == 2);
  fail_unless(tactor.gain_db == -4.5 && tactor.equalizer == some_tactor().equalizer);
  fail_unless(read.tactors.at(0).gain_db == 0 && read.tactors.at(0).equalizer.empty());
  fail_if(read.tactors.at(0).latency.has_value());
}

CHECK_TEST(endless_files_are_refused)
{
  for (const auto &[path, says] :
       { std::pair{ "/dev/zero", "got a device" }, std::pair{ "/", "got a folder" },
         std::pair{ "/nowhere", "No such file" } }) {
    const std::string got = read_calibration(path).error();
    fail_unless(got.find(says) != std::string::npos, "'%s' instead of '%s'", got.c_str(), says);
  }
}

CHECK_TEST(damaged_files_are_refused_with_the_place)
{
  const std::string head = "[Calibration]\nversion=1\n";
  expect_refusal("", "version");
  expect_refusal("version=1\n", "cannot read");
  expect_refusal("[Calibration]\nversion=2\n[Tactor 0]\n", "expected 1, got 2");
  expect_refusal(head, "expected at least one group");
  expect_refusal(head + "[Tactor x]\n", "[Tactor x]");
  expect_refusal(head + "[Tactor -1]\n", "expected a tactor's index");
  expect_refusal(head + "[Tactor 0]\nlatency-ms=soon\n", "latency-ms");
  expect_refusal(head + "[Tactor 0]\nlatency-ms=nan\n", "latency-ms");
  expect_refusal(head + "[Tactor 0]\nlatency-ms=-1\n", "expected 0 to 1000, got -1");
  expect_refusal(head + "[Tactor 0]\nstart-volts=0.4\nhold-volts=0.5\n", "hold-volts");
  expect_refusal(head + "[Tactor 0]\nrise-table-step-volts=0.1\nrise-table-ms=1;2;3;\n",
                 "rise-table-ms");
  expect_refusal(head + "[Tactor 0]\nrise-table-ms=1;2;3;4;\n", "rise-table-step-volts");
  expect_refusal(head + "[Tactor 0]\nrise-quadratic-ms=1;2;3;\n", "expected six numbers, got 3");
  expect_refusal(head + "[Tactor 0]\nrise-model=cubic\n", "expected table or quadratic");
  expect_refusal(head + "[Tactor 0]\nvibration-volts=1;2;\nvibration=1;\n", "one for each");
  expect_refusal(head + "[Tactor 0]\nvibration-volts=1;2;\nvibration=2;1;\n", "rising");
  expect_refusal(head + "[Tactor 0]\nvibration-volts=1;1;\nvibration=1;2;\n", "rising");
  expect_refusal(head + "[Tactor 0]\nvibration-volts=1;2;\nvibration=0;0;\n", "vibrates");
  expect_refusal(head + "[Tactor 0]\ngain-db=25\n", "gain-db: expected -60 to 24, got 25");
  expect_refusal(head + "[Tactor 0]\ngain-db=loud\n", "gain-db");
  const auto equalizer = [&](const char *hz, const char *db, const char *q) {
    return head + "[Tactor 0]\nequalizer-hz=" + hz + "\nequalizer-db=" + db + "\nequalizer-q=" + q
           + "\n";
  };
  expect_refusal(equalizer("0.5", "1", "1"), "equalizer-hz: expected 1 to 1000, got 0.5");
  expect_refusal(equalizer("60", "-25", "1"), "equalizer-db: expected -24 to 24, got -25");
  expect_refusal(equalizer("60", "1", "21"), "equalizer-q: expected 0.1 to 20, got 21");
  expect_refusal(equalizer("60;70;", "1", "1;1;"),
                 "equalizer-db: expected as many numbers as equalizer-hz has, 2, got 1");
  expect_refusal(equalizer("60", "1", "1;1;"),
                 "equalizer-q: expected as many numbers as equalizer-hz has, 1, got 2");
  expect_refusal(equalizer("1;2;3;4;5;6;7;8;9;", "1", "1"), "expected at most 8 numbers, got 9");
  expect_refusal(head + "[Tactor 0]\nequalizer-db=3\n", "equalizer-hz: expected numbers");
  fail_unless(refusal(head + "[Tactor 0]\n").empty());
}

CHECK_TEST(missing_file_is_named)
{
  const auto read = read_calibration("/nowhere/motors.calibration");
  fail_if(read.has_value());
  fail_unless(read.error().find("/nowhere/motors.calibration") != std::string::npos);
}

CHECK_TEST(unmeasured_motors_are_the_papers)
{
  const Calibration calibration{ .tactors = { { 2, some_tactor() } } };
  const std::vector<MotorParameters> motors = calibration.motors(3.0);
  fail_unless(motors.size() == 3);
  fail_unless(motors[2].latency == Time(12ms) && motors[2].thresholds_measured);
  fail_unless(motors[2].rise_time(0, 1.5) == Time(80'125'000));
  fail_unless(motors[0].rise_time(0, 1.5) == RiseTime()(0, 1.5) && !motors[0].thresholds_measured);
  // With a table and a quadratic fit, the file says which one to use. Without a table the quadratic
  // is used, also between the points of its grid.
  TactorCalibration without = some_tactor();
  without.prefers_quadratic = true;
  const RiseTime rise_time = Calibration{ .tactors = { { 0, without } } }.motors(3.0)[0].rise_time;
  fail_unless_near(static_cast<double>(rise_time(0.55, 1.75).count()) / 1e6,
                   rise_time_quadratic_ms(0.55, 1.2), 0.2);
}

// Two motors, one twice as strong, both with curved responses: perceived strength is equal on both,
// and linear in the level.
CHECK_TEST(levels_are_felt_equally_and_linearly)
{
  TactorCalibration weak;
  TactorCalibration strong;
  for (int tenth = 5; tenth <= 30; tenth++) {
    const double volts = 0.1 * tenth;
    weak.vibration.push_back({ volts, volts * volts / 9 });
    strong.vibration.push_back({ volts, 2 * std::sqrt(volts / 3) });
  }
  const Calibration calibration{ .perception_exponent = 0.7,
                                 .tactors = { { 0, weak }, { 1, strong } } };
  CommandPlanner planner(2, unlimited({ .rate = 0, .compensation = Compensation::none }),
                         calibration.motors(3.0));
  const auto felt = [&](double amplitude) {
    return std::pow(amplitude, 0.7);
  };
  int told = 0;
  for (int i = 1; i <= 20; i++) {
    const float level = static_cast<float>(i) / 20;
    for (const Command &command : planner.plan(i * 1s, 1s, std::vector<float>{ level, level })) {
      const double volts = command.volts;
      if (volts == 0 || volts < 0.51)
        continue;
      const double amplitude = command.tactor == 0 ? volts * volts / 9 : 2 * std::sqrt(volts / 3);
      fail_unless_near(felt(amplitude), level, 0.02);
      told++;
    }
  }
  fail_unless(told > 20, "%d commands", told);
}

// The measured start and hold voltages apply, not voltage-min: a level that does not start a motor
// at rest keeps a turning one on.
CHECK_TEST(thresholds_are_each_tactors_own)
{
  const Calibration calibration{ .tactors = { { 0, { .start_volts = 0.9, .hold_volts = 0.3 } } } };
  CommandPlanner planner(2, unlimited({ .rate = 0, .compensation = Compensation::none }),
                         calibration.motors(3.0));
  const auto volts = [&](Time time, float level, int tactor) {
    double last = -1;
    for (const Command &command : planner.plan(time, 1s, std::vector<float>{ level, level }))
      if (command.tactor == tactor)
        last = command.volts;
    return last;
  };
  fail_unless(volts(0s, 0.25F, 0) == -1);          // 0.75 V does not start it
  fail_unless_near(volts(1s, 0.5F, 0), 1.5, 1e-6); // 1.5 V does
  fail_unless_near(volts(2s, 0.12F, 0), 0.36, 1e-6);
  fail_unless(volts(3s, 0.05F, 0) == 0);
  fail_unless_near(volts(4s, 0.25F, 1), 0.75, 1e-6); // the other motor is the paper's
}

// The latency of the whole chain is measured per tactor. It replaces the latency that the driver
// reports.
CHECK_TEST(latency_is_part_of_the_lead)
{
  const Calibration calibration{ .tactors = { { 0, { .latency = 21ms } } } };
  CommandPlanner planner(2, unlimited({ .rate = 0, .transport_latency = 3ms }),
                         calibration.motors(3.0));
  const std::vector<Command> commands = planner.plan(1s, 1s, std::vector<float>{ 1, 1 });
  fail_unless(commands.size() == 2);
  fail_unless(commands[0].lead == RiseTime()(0, 3) + 21ms);
  fail_unless(commands[1].lead == RiseTime()(0, 3) + 3ms);
  for (const Command &command : planner.plan(2s, 1s, std::vector<float>{ 0, 0 }))
    fail_unless(command.lead == (command.tactor == 0 ? 21ms : 3ms));
}

CHECK_MAIN(calibration)
