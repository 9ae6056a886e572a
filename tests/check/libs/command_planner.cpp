// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/command_planner.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "frame_rate.h"
#include "support/tolerance.h"
#include "unlimited.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A level that repeats every seventh frame. No block here has seven frames, so each has a command.
/// None is stronger by half than another, which would begin a block.
float
level_of(std::int64_t frame)
{
  return 0.6F + 0.04F * static_cast<float>(frame % 7);
}

/// The voltage that a single tactor gets for a level.
double
volts_for(const PlannerSettings &settings, float level)
{
  const std::vector<Command> commands = first_plan(settings, 1, { level });
  fail_unless(commands.size() <= 1);
  return commands.empty() ? 0.0 : commands[0].volts;
}

/// Commands as text: "tactor:hundredths of a volt ".
std::string
text(const std::vector<Command> &commands)
{
  std::string all;
  for (const Command &command : commands)
    all += std::to_string(command.tactor) + ":" + std::to_string(std::lround(command.volts * 100))
           + " ";
  return all;
}

} // namespace

CHECK_TEST(test_blocks_do_not_drift)
{
  const FrameRate rates[] = { { 24, 1 }, { 25, 1 }, { 30000, 1001 }, { 30, 1 },
                              { 50, 1 }, { 60, 1 }, { 24000, 1001 }, { 60000, 1001 } };
  for (const FrameRate &rate : rates) {
    CommandPlanner planner(1, unlimited());
    std::int64_t blocks = 0;
    const std::int64_t frames = 600 * rate.numerator / rate.denominator;
    for (std::int64_t frame = 0; frame < frames; frame++) {
      const auto commands = planner.plan(rate.frame(frame), rate.duration(frame),
                                         std::vector<float>{ level_of(frame) });
      // In whole numbers: does the middle of the frame, (2k + 1) / (2 fps), lie at or after the
      // block's start, n / 5 Hz? The first block begins with the first frame.
      const bool begins
          = blocks == 0 || 5 * (2 * frame + 1) * rate.denominator >= 2 * blocks * rate.numerator;
      fail_unless(commands.size() == (begins ? 1 : 0), "frame %d at %d/%d fps",
                  static_cast<int>(frame), static_cast<int>(rate.numerator),
                  static_cast<int>(rate.denominator));
      if (!begins)
        continue;
      fail_unless(commands[0].effect == rate.frame(frame));
      fail_unless(2 * std::abs((commands[0].effect - blocks * 200ms).count())
                  <= rate.duration(frame).count() + 4);
      blocks++;
    }
    fail_unless(blocks == 3000 || blocks == 2999);
  }
}

CHECK_TEST(test_rounded_stamps)
{
  // At 30 fps, with timestamps that are sums of rounded durations, every sixth frame begins a
  // block.
  for (const Time duration : { 33'333'333ns, 33'333'334ns }) {
    CommandPlanner planner(1, unlimited());
    for (std::int64_t frame = 0; frame < 18000; frame++) {
      const auto commands
          = planner.plan(frame * duration, duration, std::vector<float>{ level_of(frame) });
      fail_unless(commands.size() == (frame % 6 == 0 ? 1 : 0), "frame %d", static_cast<int>(frame));
    }
  }
}

CHECK_TEST(test_every_map_is_a_block)
{
  for (const double rate : { 0.0, 24.0, 30.0, 100.0 }) {
    CommandPlanner planner(1, unlimited({ .rate = rate }));
    for (int frame = 0; frame < 1000; frame++) {
      const FrameRate film{ 24, 1 };
      const auto commands = planner.plan(film.frame(frame), film.duration(frame),
                                         std::vector<float>{ level_of(frame) });
      fail_unless(commands.size() == 1 && commands[0].effect == film.frame(frame));
    }
  }
}

CHECK_TEST(test_unknown_durations)
{
  // Durations of 0 or less count as 1/30 s.
  for (const Time duration : { 0ns, -1ns }) {
    CommandPlanner planner(1, unlimited());
    for (int frame = 0; frame < 100; frame++)
      fail_unless(
          planner.plan(kThirty.frame(frame), duration, std::vector<float>{ level_of(frame) }).size()
          == (frame % 6 == 0 ? 1 : 0));
  }
}

CHECK_TEST(test_holes)
{
  CommandPlanner planner(1, unlimited());
  std::vector<int> begun;
  for (int frame = 0; frame < 60; frame++) {
    // A gap shorter than a block keeps the grid of blocks. One that covers a whole block starts a
    // new grid.
    if ((frame > 3 && frame < 9) || (frame > 20 && frame < 34))
      continue;
    if (!planner
             .plan(kThirty.frame(frame), kThirty.duration(frame),
                   std::vector<float>{ level_of(frame) })
             .empty())
      begun.push_back(frame);
  }
  fail_unless(begun == (std::vector<int>{ 0, 9, 12, 18, 34, 40, 46, 52, 58 }));
}

CHECK_TEST(test_level_of_the_blocks_first_map)
{
  // The paper's way: a block has the level that it begins with.
  CommandPlanner planner(1, unlimited({ .compensation = Compensation::frame_block }));
  for (int frame = 0; frame < 6; frame++) {
    const float level = frame == 0 ? 0.5F : 1.0F;
    const auto commands
        = planner.plan(kThirty.frame(frame), kThirty.duration(frame), std::vector<float>{ level });
    fail_unless(text(commands) == (frame == 0 ? "0:150 " : ""));
  }
  // A block without changes has no commands.
  fail_unless(planner.plan(kThirty.frame(6), 33ms, std::vector<float>{ 0.5F }).empty());
  fail_unless(text(planner.plan(kThirty.frame(12), 33ms, std::vector<float>{ 1.0F })) == "0:300 ");
}

CHECK_TEST(test_no_cue_is_lost)
{
  // A cue of two frames, wherever it begins in a block of six, is felt from its first frame on, for
  // a block. Without commands in between, the next one ends it.
  for (int begin = 1; begin < 20; begin++) {
    CommandPlanner planner(1, unlimited());
    std::vector<std::pair<int, std::string>> planned;
    for (int frame = 0; frame < 40; frame++) {
      const float level = frame == begin || frame == begin + 1 ? 0.5F : 0.0F;
      const auto commands = planner.plan(kThirty.frame(frame), kThirty.duration(frame),
                                         std::vector<float>{ level });
      if (!commands.empty())
        planned.emplace_back(frame, text(commands));
    }
    const std::vector<std::pair<int, std::string>> expected{ { begin, "0:150 " },
                                                             { begin + 6, "0:0 " } };
    fail_unless(planned == expected, "begins with frame %d", begin);
  }
}

CHECK_TEST(test_strongest_frame)
{
  // What becomes stronger by half within a block is felt at once, and others go on until their
  // block is over.
  CommandPlanner planner(2, unlimited());
  const auto plan = [&](int frame, float one, float other) {
    return text(planner.plan(kThirty.frame(frame), kThirty.duration(frame),
                             std::vector<float>{ one, other }));
  };
  fail_unless(plan(0, 0.4F, 0) == "0:120 ");
  fail_unless(plan(1, 0.5F, 0).empty());
  fail_unless(plan(2, 0, 0.8F) == "1:240 "); // the first has had 2 of its 6 frames
  fail_unless(plan(3, 0, 0.9F).empty());
  fail_unless(plan(7, 0.2F, 0.2F).empty());
  fail_unless(plan(8, 0.2F, 0.2F) == "0:60 1:60 "); // six frames later
  fail_unless(plan(9, 0.2F, 0.35F) == "1:105 ");
  fail_unless(plan(10, 0.0F, 0.6F) == "1:180 ");
}

CHECK_TEST(test_silence)
{
  CommandPlanner planner(3, unlimited());
  fail_unless(planner.silence(0s).empty());
  fail_unless(text(planner.plan(1s, 33ms, std::vector<float>{ 1.0F, 0.0F, 0.5F }))
              == "0:300 2:150 ");
  const auto commands = planner.silence(1050ms);
  fail_unless(text(commands) == "0:0 2:0 ");
  for (const Command &command : commands)
    fail_unless(command.effect == 1050ms && command.lead == 0s);
  fail_unless(planner.silence(1100ms).empty());
  // The next map begins a block and a new grid.
  const std::vector<float> levels{ 0.0F, 1.0F, 0.0F };
  const std::vector<float> none{ 0.0F, 0.0F, 0.0F };
  fail_unless(text(planner.plan(1100ms, 33ms, levels)) == "1:300 ");
  fail_unless(planner.plan(1200ms, 33ms, none).empty());
  fail_unless(text(planner.plan(1300ms, 33ms, none)) == "1:0 ");
}

CHECK_TEST(test_silence_before_what_is_planned)
{
  // A gap may begin before the last map's time. Its command must not be due before that map's
  // command.
  CommandPlanner planner(1, unlimited());
  const Command on = planner.plan(1s, 33ms, std::vector<float>{ 1.0F })[0];
  const Command off = planner.silence(0s)[0];
  fail_unless(off.due() >= on.due());
  fail_unless(off.lead >= 0s);
}

CHECK_TEST(test_reset)
{
  CommandPlanner planner(2, unlimited());
  const std::vector<float> levels{ 1.0F, 0.4F };
  const auto first = planner.plan(10s, 33ms, levels);
  fail_unless(first.size() == 2);
  fail_unless(planner.plan(10s + 33ms, 33ms, std::vector<float>{ 0.0F, 0.0F }).empty());
  // All motors are at rest, and time may start again from zero.
  planner.reset(10s + 66ms);
  fail_unless(planner.silence(0s).empty());
  planner.reset(0s);
  auto again = planner.plan(0s, 33ms, levels);
  for (Command &command : again)
    command.effect += 10s;
  fail_unless(again == first);
}

CHECK_TEST(test_silenced)
{
  CommandPlanner planner(2, unlimited());
  const std::vector<float> levels{ 1.0F, 0.4F };
  fail_unless(text(planner.plan(1s, 33ms, levels)) == "0:300 1:120 ");
  // All motors are at rest and time goes on. No command is due before the silence.
  planner.silenced(2s);
  fail_unless(planner.silence(2s).empty());
  const auto again = planner.plan(2s, 33ms, levels);
  fail_unless(text(again) == "0:300 1:120 ");
  for (const Command &command : again)
    fail_unless(command.due() == 2s && command.effect == 2s);
}

CHECK_TEST(test_change_of_rate)
{
  CommandPlanner planner(1, unlimited());
  PlannerSettings settings;
  planner.plan(0s, 33ms, std::vector<float>{ 1.0F });
  settings.intensity = 0.5;
  planner.set_settings(unlimited(settings));
  fail_unless(planner.settings().intensity == 0.5);
  // A change of the rate starts a new grid, other settings keep it.
  fail_unless(planner.plan(100ms, 33ms, std::vector<float>{ 1.0F }).empty());
  settings.rate = 10;
  planner.set_settings(unlimited(settings));
  fail_unless(text(planner.plan(133ms, 33ms, std::vector<float>{ 1.0F })) == "0:150 ");
  fail_unless(planner.plan(200ms, 33ms, std::vector<float>{ 0.0F }).empty());
  fail_unless(text(planner.plan(233ms, 33ms, std::vector<float>{ 0.0F })) == "0:0 ");
}

CHECK_TEST(test_mapping)
{
  const auto planned = [](std::vector<int> mapping, int tactors, const std::vector<float> &levels) {
    PlannerSettings settings;
    settings.mapping = std::move(mapping);
    return text(first_plan(settings, tactors, levels));
  };
  const std::vector<float> levels{ 0.2F, 0.4F, 0.6F, 0.8F };
  fail_unless(planned({}, 4, levels) == "0:60 1:120 2:180 3:240 ");
  fail_unless(planned({}, 6, levels) == "0:60 1:120 2:180 3:240 ");
  fail_unless(planned({}, 2, levels) == "0:60 1:120 "); // more cells than tactors
  fail_unless(planned({}, 0, levels).empty());
  fail_unless(planned({}, -1, levels).empty());
  fail_unless(planned({ 3, 2, 1, 0 }, 4, levels) == "0:240 1:180 2:120 3:60 ");
  fail_unless(planned({ -1, 0, -1, 1 }, 2, levels) == "0:120 1:240 ");
  fail_unless(planned({ 1, 1, 0, 0 }, 2, levels) == "0:240 1:120 "); // the stronger one
  fail_unless(planned({ 0, 0, 1, 1 }, 2, { 0.9F, 0.4F, 0.0F, 0.5F }) == "0:270 1:150 ");
  fail_unless(planned({ 7, 0, 2, -5 }, 2, levels) == "0:120 ");
  fail_unless(planned({ 1, 0 }, 4, levels) == "0:120 1:60 "); // cells without an entry are ignored
  fail_unless(planned({ 0, 1, 2, 3, 4, 5 }, 6, levels) == "0:60 1:120 2:180 3:240 ");
  fail_unless(planned({}, 3, {}).empty());
}

CHECK_TEST(test_validate_mapping)
{
  const auto problem = [](std::vector<int> mapping, int cells, int tactors) {
    return CommandPlanner::validate_mapping(mapping, cells, tactors);
  };
  fail_unless(problem({}, 9, 9).empty());
  fail_unless(problem({}, 4, 9).empty());
  fail_unless(problem({ 3, -1, 0, 0 }, 4, 4).empty());
  const auto names = [](const std::string &text, const char *one, const char *other) {
    return text.find(one) != std::string::npos && text.find(other) != std::string::npos
           && text.find('\n') == std::string::npos;
  };
  fail_unless(names(problem({}, 10, 9), "10", "9"));
  fail_unless(names(problem({ 0, 1, 2 }, 4, 9), "3", "4"));
  fail_unless(names(problem({ 0, 1, 2, 3, 4 }, 4, 9), "5", "4"));
  fail_unless(names(problem({ 0, 1, 2, 16 }, 4, 16), "16", "tactor"));
  fail_unless(problem({ 0, 1, 2, 15 }, 4, 16).empty());
}

CHECK_TEST(test_volts)
{
  fail_unless_near(volts_for({}, 0.5F), 1.5, 1e-6);
  fail_unless_near(volts_for({}, 1.0F), 3.0, 0);
  fail_unless_near(volts_for({ .volts_max = 2.5 }, 1.0F), 2.5, 0);
  fail_unless_near(volts_for({ .volts_max = 5.0 }, 0.5F), 2.5, 0);
  fail_unless_near(volts_for({ .intensity = 0.5 }, 0.8F), 1.2, 1e-6);
  fail_unless_near(volts_for({ .intensity = 0 }, 1.0F), 0, 0);
  // Below the minimum voltage a tactor is off.
  fail_unless(volts_for({}, 0.16F) == 0);
  fail_unless_near(volts_for({}, 0.17F), 0.51, 1e-6);
  fail_unless(volts_for({ .volts_min = 0.6 }, 0.19F) == 0);
  fail_unless_near(volts_for({ .volts_min = 0.6 }, 0.2F), 0.6, 1e-6);
  fail_unless(volts_for({ .intensity = 0.3 }, 0.5F) == 0);
  fail_unless_near(volts_for({ .volts_min = 0.1 }, 0.1F), 0.3, 1e-6);
  fail_unless(volts_for({ .volts_max = 0.4 }, 1.0F) == 0);
}

CHECK_TEST(test_least_voltage_as_a_float)
{
  // A level one float below 1/6 stands for 0.5 V, at which the motor turns.
  const float sixth = std::nextafter(1.0F / 6.0F, 0.0F);
  fail_unless(3.0 * static_cast<double>(sixth) < 0.5);
  const auto commands = first_plan({}, 1, { sixth });
  fail_unless(commands.size() == 1);
  fail_unless(commands[0].volts == 0.5);
  fail_unless(commands[0].lead == RiseTime()(0, 0.5));
}

CHECK_TEST(test_levels_out_of_range)
{
  fail_unless(volts_for({}, 7.0F) == 3.0);
  fail_unless(volts_for({}, kInfinity) == 3.0);
  fail_unless(volts_for({}, -0.5F) == 0);
  fail_unless(volts_for({}, -kInfinity) == 0);
  fail_unless(volts_for({}, kNan) == 0);
  // NaN turns off a motor that is on.
  CommandPlanner planner(1, unlimited());
  planner.plan(0s, 33ms, std::vector<float>{ 1.0F });
  fail_unless(text(planner.plan(1s, 33ms, std::vector<float>{ kNan })) == "0:0 ");
}

CHECK_TEST(test_order_lead_and_range)
{
  std::mt19937 random(4);
  std::uniform_real_distribution<float> level(-0.2F, 1.2F);
  std::uniform_int_distribution<int> per_cent(0, 99);
  constexpr int kTactors = 4;
  for (int play = 0; play < 40; play++) {
    const auto settings = [&] {
      return PlannerSettings{ .rate = per_cent(random) % 3 * 7.0,
                              .compensation = static_cast<Compensation>(per_cent(random) % 3),
                              .max_lead = per_cent(random) * 2ms,
                              .transport_latency = per_cent(random) * 1ms,
                              .volts_max = 0.5 + 0.03 * per_cent(random),
                              .intensity = 0.01 * per_cent(random) };
    };
    CommandPlanner planner(kTactors, unlimited(settings()));
    std::vector<Time> last(kTactors, Time::min());
    const FrameRate rate{ 24 + per_cent(random), 1 };
    for (int frame = 0; frame < 1000; frame++) {
      const int dice = per_cent(random);
      if (dice < 2)
        planner.set_settings(unlimited(settings()));
      if (dice > 95) {
        frame += dice; // a gap
        continue;
      }
      std::vector<float> levels(kTactors);
      for (float &one : levels)
        one = level(random);
      const auto commands = dice < 5
                                ? planner.silence(rate.frame(frame))
                                : planner.plan(rate.frame(frame), rate.duration(frame), levels);
      const PlannerSettings &now = planner.settings();
      const Time transport
          = now.compensation == Compensation::exact ? now.transport_latency : Time(0);
      for (const Command &command : commands) {
        fail_unless(command.tactor >= 0 && command.tactor < kTactors);
        fail_unless(command.effect == rate.frame(frame));
        fail_unless(command.lead >= 0s && command.lead <= now.max_lead + transport);
        fail_unless(
            command.volts == 0
            || (command.volts >= 0.5 && command.volts <= now.volts_max * now.intensity + 1e-6));
        Time &before = last[static_cast<std::size_t>(command.tactor)];
        fail_unless(command.due() >= before, "play %d, frame %d: due before its predecessor", play,
                    frame);
        before = command.due();
      }
    }
  }
}

CHECK_MAIN(command_planner)
