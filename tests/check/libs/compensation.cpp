// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/command_planner.h"

// When the planner issues commands relative to their frames. Its other tests are in
// command_planner.cpp.

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "frame_rate.h"
#include "support/tolerance.h"
#include "unlimited.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;

namespace {

RiseTime
constant(double milliseconds)
{
  return RiseTime(RiseTimeTable{ .step_volts = 1, .size = 1, .milliseconds = { milliseconds } });
}

double
seconds(Time time)
{
  return std::chrono::duration<double>(time).count();
}

/// Eq. 1 computed independently, in seconds.
double
oracle_rise(double start, double target)
{
  if (target <= start || target < 0.5)
    return 0;
  const double offset = target - start;
  return (241.9 + offset * (38.86 * offset - 175.7) + start * (18.07 * start - 117.7)
          + 49.59 * offset * start)
         / 1000;
}

/// The motor model computed independently, in seconds: powers of the share of the step that
/// remains.
struct OracleMotor
{
  double since = 0;
  double from = 0;
  double steady = 0;

  double amplitude(double time) const
  {
    if (time <= since)
      return from;
    if (from < 0.9 * steady) {
      const double left = 0.1 * steady / (steady - from);
      return steady - (steady - from) * std::pow(left, (time - since) / oracle_rise(from, steady));
    }
    return steady + (from - steady) * std::pow(10.0, -(time - since) / 0.030);
  }
  void set(double time, double volts)
  {
    from = amplitude(time);
    since = time;
    steady = volts < 0.5 ? 0 : volts;
  }
};

} // namespace

CHECK_TEST(test_papers_worked_example)
{
  // The paper's example: "when 60 ms is found as the rising time …, the first three frames of the
  // data block are written with the previous input voltage and the remaining two frames are filled
  // with the target voltage at the next data block". 30 frames a second, five in a block.
  const PlannerSettings settings{ .rate = 6, .compensation = Compensation::frame_block };
  CommandPlanner planner(1, unlimited(settings), constant(60));
  std::vector<Command> commands;
  for (int frame = 0; frame < 10; frame++) {
    const float level = frame < 5 ? 0.5F : 1.0F;
    for (const Command &command :
         planner.plan(kThirty.frame(frame), kThirty.duration(frame), std::vector<float>{ level }))
      commands.push_back(command);
  }
  fail_unless(commands.size() == 2);
  fail_unless(commands[0].effect == kThirty.frame(0) && commands[0].volts == 1.5);
  fail_unless(commands[1].effect == kThirty.frame(5) && commands[1].volts == 3.0);
  for (int frame = 0; frame < 5; frame++) {
    const Time middle = (kThirty.frame(frame) + kThirty.frame(frame + 1)) / 2;
    const double voltage = commands[1].due() <= middle ? commands[1].volts : commands[0].volts;
    fail_unless(voltage == (frame < 3 ? 1.5 : 3.0), "frame %d has %g V", frame, voltage);
  }
  fail_unless_near(commands[1].lead.count(), 2e9 / 30, 2);
}

CHECK_TEST(test_frame_block_rounds_up_to_frames)
{
  struct Case
  {
    double rise;
    Time frame;
    Time max_lead;
    int frames;
  };
  const Case cases[] = {
    { 0, 40ms, 150ms, 0 },   { 0.001, 40ms, 150ms, 1 }, { 39.9, 40ms, 150ms, 1 },
    { 40, 40ms, 150ms, 1 },  { 40.1, 40ms, 150ms, 2 },  { 100, 40ms, 150ms, 3 },
    { 160, 40ms, 150ms, 3 }, { 160, 40ms, 160ms, 4 },   { 400, 40ms, 150ms, 3 },
    { 60, 40ms, 39ms, 0 },   { 60, 10ms, 150ms, 6 },    { 60, 200ms, 150ms, 0 },
  };
  for (const Case &c : cases) {
    const PlannerSettings settings{ .compensation = Compensation::frame_block,
                                    .max_lead = c.max_lead };
    CommandPlanner planner(1, unlimited(settings), constant(c.rise));
    const auto commands = planner.plan(1s, c.frame, std::vector<float>{ 1.0F });
    fail_unless(commands.size() == 1);
    fail_unless(commands[0].lead == c.frames * c.frame, "%g ms in frames of %g ms: lead %g ms",
                c.rise, c.frame.count() / 1e6, commands[0].lead.count() / 1e6);
  }
  // Three frames of 33 333 333 ns or 33 333 334 ns last 100 ms.
  for (const Time frame : { 33'333'333ns, 33'333'334ns }) {
    CommandPlanner planner(1, unlimited({ .compensation = Compensation::frame_block }),
                           constant(100));
    fail_unless(planner.plan(1s, frame, std::vector<float>{ 1.0F })[0].lead == 3 * frame);
  }
  // An unknown frame duration counts as 1/30 s.
  CommandPlanner planner(1, unlimited({ .compensation = Compensation::frame_block }), constant(60));
  fail_unless_near(planner.plan(0s, 0s, std::vector<float>{ 1.0F })[0].lead.count(), 2e9 / 30, 1);
}

CHECK_TEST(test_exact_lead_at_rest)
{
  // Eq. 1 with Vs = 0, computed by hand
  struct Case
  {
    float level;
    double ms;
  };
  const Case cases[] = {
    { 1.0F, 64.54 },          // 3 V: 241.9 − 527.1 + 349.74
    { 0.5F, 65.785 },         // 1.5 V: 241.9 − 263.55 + 87.435
    { 0.75F, 43.30375 },      // 2.25 V: 241.9 − 395.325 + 196.72875
    { 0.25F, 131.98375 },     // 0.75 V: 241.9 − 131.775 + 21.85875
    { 1.0F / 6.0F, 163.765 }, // 0.5 V: 241.9 − 87.85 + 9.715
  };
  for (const Case &c : cases) {
    const auto commands = first_plan({}, 1, { c.level });
    fail_unless(commands.size() == 1);
    fail_unless(commands[0].effect == 0s);
    fail_unless_near(commands[0].lead.count() / 1e6, c.ms, 1e-5);
  }
  fail_unless(first_plan({ .max_lead = 150ms }, 1, { 1.0F / 6.0F })[0].lead == 150ms);
}

CHECK_TEST(test_other_compensations_at_rest)
{
  PlannerSettings settings{ .compensation = Compensation::none };
  fail_unless(first_plan(settings, 1, { 1.0F })[0].lead == 0s);
  settings.transport_latency = 4ms;
  fail_unless(first_plan(settings, 1, { 1.0F })[0].lead == 0s);

  // exact: the transport latency is added, for falling commands, too.
  settings.compensation = Compensation::exact;
  CommandPlanner planner(1, unlimited(settings), constant(60));
  fail_unless(planner.plan(0s, 33ms, std::vector<float>{ 1.0F })[0].lead == 64ms);
  fail_unless(planner.plan(1s, 33ms, std::vector<float>{ 0.5F })[0].lead == 4ms);
  fail_unless(planner.plan(2s, 33ms, std::vector<float>{ 0.0F })[0].lead == 4ms);
  settings.max_lead = 150ms;
  CommandPlanner slow(1, unlimited(settings), constant(400));
  fail_unless(slow.plan(0s, 33ms, std::vector<float>{ 1.0F })[0].lead == 154ms);
}

CHECK_TEST(test_falling_commands_have_no_lead)
{
  for (const Compensation compensation : { Compensation::exact, Compensation::frame_block })
    for (const float level : { 0.7F, 0.3F, 0.0F }) {
      CommandPlanner planner(1, unlimited({ .compensation = compensation }));
      planner.plan(0s, 33ms, std::vector<float>{ 1.0F });
      const auto commands = planner.plan(1s, 33ms, std::vector<float>{ level });
      fail_unless(commands.size() == 1);
      fail_unless(commands[0].lead == 0s && commands[0].effect == 1s);
    }
}

CHECK_TEST(test_exact_against_brute_force)
{
  constexpr double kGrid = 10e-6;
  std::mt19937 random(3);
  std::uniform_int_distribution<int> tenth(0, 10);
  for (const double rate : { 5.0, 30.0 })
    for (const Time max_lead : { 150ms, 80ms }) {
      CommandPlanner planner(1, unlimited({ .rate = rate, .max_lead = max_lead }));
      OracleMotor motor;
      double previous = -1e9;
      int searched = 0;
      for (int frame = 0; frame < (rate == 5.0 ? 6000 : 1500); frame++) {
        const auto commands
            = planner.plan(kThirty.frame(frame), kThirty.duration(frame),
                           std::vector<float>{ 0.1F * static_cast<float>(tenth(random)) });
        if (commands.empty())
          continue;
        const double effect = seconds(commands[0].effect);
        const double earliest = std::max(previous, effect - seconds(max_lead));
        const double volts = commands[0].volts;
        const auto arrives = [&](double time) {
          return time + oracle_rise(motor.amplitude(time), volts) <= effect + 2e-9;
        };
        double expected = effect;
        while (expected > earliest && !arrives(expected))
          expected = std::max(expected - kGrid, earliest);
        const double got = seconds(commands[0].due());
        fail_unless(got >= expected - 2e-6 && got <= expected + kGrid + 2e-6,
                    "rate %g, frame %d: to %g V due %.3f ms before, not %.3f", rate, frame, volts,
                    (effect - got) * 1e3, (effect - expected) * 1e3);
        searched += expected < effect && expected > earliest;
        previous = got;
        motor.set(got, volts);
      }
      fail_unless(searched > 100, "only %d commands were searched for", searched);
    }
}

CHECK_TEST(test_amplitude_arrives_with_the_frame)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<float> level(0.0F, 1.0F);
  for (const FrameRate &rate : { FrameRate{ 24, 1 }, kThirty, FrameRate{ 60, 1 } }) {
    CommandPlanner planner(1, unlimited());
    MotorModel motor;
    int rising = 0;
    // Levels that change within two blocks may come too late, as commands are in order.
    const int blocks = 2 * static_cast<int>(rate.numerator / 5) + 2;
    float now = 0;
    for (int frame = 0; frame < 40000; frame++) {
      if (frame % blocks == 0)
        now = level(random);
      const auto commands
          = planner.plan(rate.frame(frame), rate.duration(frame), std::vector<float>{ now });
      if (commands.empty())
        continue;
      const Command &command = commands[0];
      const double goal = 0.9 * command.volts;
      const bool rises = motor.amplitude(command.due()) < goal;
      motor.set(command.due(), command.volts);
      if (!rises || command.lead >= planner.settings().max_lead)
        continue;
      rising++;
      fail_unless(motor.amplitude(command.effect - 1ms) < goal);
      fail_unless(motor.amplitude(command.effect + 1ms) >= goal, "frame %d: %g V of %g", frame,
                  motor.amplitude(command.effect), command.volts);
    }
    fail_unless(rising > 300, "only %d commands rise", rising);
  }
}

CHECK_MAIN(compensation)
