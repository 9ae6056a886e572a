// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/command_planner.h"

// The planner's limits, checked by an independent model of the motors.

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "frame_rate.h"
#include "motor_account.h"
#include "support/tolerance.h"
#include "unlimited.h"

#include "support/check_tests.h"

namespace {

/// A film that is hard on motors: each tactor changes its level or goes off at random times.
class HardFilm
{
public:
  HardFilm(unsigned seed, int tactors, double on_seconds, double off_seconds)
      : random_(seed), on_(1 / on_seconds), off_(1 / off_seconds),
        levels_(static_cast<std::size_t>(tactors), 0.0F), left_(levels_.size(), 0.0)
  {
  }
  const std::vector<float> &next(double frame_seconds)
  {
    for (std::size_t i = 0; i < levels_.size(); i++) {
      left_[i] -= frame_seconds;
      if (left_[i] > 0)
        continue;
      const bool on = levels_[i] == 0 || level_(random_) < 0.3F;
      levels_[i] = on ? level_(random_) : 0.0F;
      left_[i] = on ? on_(random_) : off_(random_);
    }
    return levels_;
  }

private:
  std::mt19937 random_;
  std::exponential_distribution<double> on_;
  std::exponential_distribution<double> off_;
  std::uniform_real_distribution<float> level_{ 0.05F, 1.1F };
  std::vector<float> levels_;
  std::vector<double> left_;
};

/// Plays a film of one level on one tactor and returns when it was on.
std::vector<Stretch>
play_level(CommandPlanner &planner, Time length, auto &&level)
{
  Chair chair(1);
  for (int frame = 0; kThirty.frame(frame) < length; frame++)
    chair.take(planner.plan(kThirty.frame(frame), kThirty.duration(frame),
                            std::vector<float>{ level(kThirty.frame(frame)) }));
  chair.take(planner.silence(length));
  chair.silence(length + 1s);
  return chair.stretches[0];
}

} // namespace

/// Random films and settings: no limit is ever exceeded, not even by a nanosecond.
CHECK_TEST(test_no_limit_is_ever_exceeded)
{
  std::mt19937 random(11);
  const auto dice = [&](int sides) {
    return std::uniform_int_distribution(0, sides - 1)(random);
  };
  LimitCounters acted;
  for (int play = 0; play < 60; play++) {
    const int tactors = 1 + dice(12);
    const MotorLimits limits{ .max_on_time = dice(4) ? 100ms * (1 + dice(40)) : 0ms,
                              .max_duty = dice(4) ? 0.05 + 0.05 * dice(18) : 0,
                              .max_active = dice(4) ? 1 + dice(6) : 0 };
    const PlannerSettings settings{
      .rate = std::vector{ 0.0, 5.0, 5.0, 8.0, 14.0 }[static_cast<std::size_t>(dice(5))],
      .compensation = static_cast<Compensation>(dice(5) ? 0 : dice(3)),
      .max_lead = 10ms * dice(19),
      .transport_latency = 5ms * dice(4),
      .limits = limits,
      .kick_start = dice(2) == 0
    };
    const Time early = settings.max_lead + settings.transport_latency;
    CommandPlanner planner(tactors, settings);
    Chair chair(tactors);
    HardFilm film(static_cast<unsigned>(play), tactors, 0.3 + 0.5 * dice(12), 0.2 + 0.3 * dice(6));
    const FrameRate rate{ 24 + dice(40), 1 };
    int frame = 0;
    for (int maps = 0; maps < 5000; maps++, frame++) {
      const Time time = rate.frame(frame);
      const Time end = rate.frame(frame + 1);
      const std::vector<float> &levels = film.next(seconds(end - time));
      const int event = dice(1500);
      if (event == 0) { // a gap
        chair.take(planner.silence(time));
      } else if (event == 1) { // no map arrives
        const Time silenced = time + 1ms * dice(900);
        chair.silence(silenced);
        planner.silenced(silenced);
        frame += 40 + dice(40);
      } else if (event <= 4) { // a seek, which the planner learns of later
        const Time flushed = time - 1ms * dice(190);
        chair.silence(flushed);
        planner.reset(flushed);
        if (dice(2))
          planner.reset(dice(1000) * 1ms); // another one before anything was played
        chair.restart(flushed + early + 1ms * dice(2) * dice(3000));
        frame = dice(3) ? -1 : dice(100);
      } else if (event > 1480) { // a gap in the film
        frame += dice(60);
      } else {
        chair.take(planner.plan(time, end - time, levels));
      }
      if (frame >= 0)
        chair.run_to(rate.frame(frame) - 400ms);
    }
    chair.silence(rate.frame(frame) + 10s);
    for (const auto &stretches : chair.stretches) {
      if (limits.max_on_time > 0s)
        fail_unless(longest_cue(stretches) <= limits.max_on_time,
                    "play %d: on for %g s, limit %g s", play, seconds(longest_cue(stretches)),
                    seconds(limits.max_on_time));
      if (limits.max_duty > 0)
        fail_unless(seconds(fullest_minute(stretches)) <= limits.max_duty * 60,
                    "play %d: on for %g s in a minute, limit %g s", play,
                    seconds(fullest_minute(stretches)), limits.max_duty * 60);
    }
    if (limits.max_active > 0)
      fail_unless(most_at_once(chair.stretches) <= limits.max_active,
                  "play %d: %d on at once, limit %d", play, most_at_once(chair.stretches),
                  limits.max_active);
    acted.on_time += planner.limited().on_time;
    acted.duty += planner.limited().duty;
    acted.number += planner.limited().number;
  }
  fail_unless(acted.on_time > 500 && acted.duty > 500 && acted.number > 500);
}

/// Limits that are never reached change nothing but the commands' `until`.
CHECK_TEST(test_limits_out_of_reach_change_nothing)
{
  for (const bool kick_start : { false, true })
    for (const double rate : { 0.0, 5.0, 14.0 })
      for (const Compensation compensation :
           { Compensation::exact, Compensation::frame_block, Compensation::none }) {
        PlannerSettings settings{ .rate = rate,
                                  .compensation = compensation,
                                  .transport_latency = 5ms,
                                  .kick_start = kick_start };
        settings.limits = { .max_on_time = 1h, .max_duty = 0.999, .max_active = 8 };
        CommandPlanner limited(9, settings);
        CommandPlanner free(9, unlimited(settings));
        HardFilm film(3, 9, 0.8, 2.0);
        std::size_t compared = 0;
        for (int frame = 0; frame < 6000; frame++) {
          std::vector<float> levels = film.next(1 / 30.0);
          levels[4] = 0; // at most eight of nine
          auto with = limited.plan(kThirty.frame(frame), kThirty.duration(frame), levels);
          const auto without = free.plan(kThirty.frame(frame), kThirty.duration(frame), levels);
          for (Command &command : with)
            command.until = Time::max();
          fail_unless(with == without, "frame %d", frame);
          compared += with.size();
        }
        fail_unless(compared > 500);
        fail_unless(limited.limited().on_time + limited.limited().duty + limited.limited().number
                    == 0);
      }
}

/// Ordinary films stay untouched: cues of under 2 s, a third of the time, three tactors at once.
CHECK_TEST(test_film_within_limits_is_untouched)
{
  CommandPlanner limited(9, {});
  CommandPlanner free(9, unlimited());
  for (int frame = 0; frame < 30 * 300; frame++) {
    std::vector<float> levels(9, 0.0F);
    const int second = frame / 30;
    const int turn = second / 2 % 3; // 2 s each, silent after 1.6 s
    if (frame % 60 < 48)
      for (std::size_t i = 0; i < 3; i++)
        levels[i * 3 + static_cast<std::size_t>(turn)] = 0.9F;
    auto with = limited.plan(kThirty.frame(frame), kThirty.duration(frame), levels);
    for (Command &command : with)
      command.until = Time::max();
    fail_unless(with == free.plan(kThirty.frame(frame), kThirty.duration(frame), levels),
                "frame %d", frame);
  }
}

/// A level that never ends is on for 2 s, then off for 3 s and until the next block.
CHECK_TEST(test_endless_level)
{
  CommandPlanner planner(1);
  const auto stretches = play_level(planner, 100s, [](Time) { return 1.0F; });
  const Time lead = RiseTime()(0, 3.0);
  fail_unless(stretches.size() == 20);
  for (std::size_t i = 0; i < stretches.size(); i++) {
    // 3 s of rest begin at 2 s - lead and end with the next block of 200 ms.
    const Time begin = i * 5s - lead;
    fail_unless(stretches[i].begin == begin, "cue %d begins at %g s", static_cast<int>(i),
                seconds(stretches[i].begin));
    fail_unless(stretches[i].end == begin + 2s);
  }
  fail_unless(planner.limited().on_time == 20 && planner.limited().duty == 0);

  // The duty limit alone: 24 s on, then off until these leave the minute.
  CommandPlanner duty(1, { .limits = { .max_on_time = 0s } });
  const auto on = play_level(duty, 100s, [](Time) { return 1.0F; });
  fail_unless(on.size() == 2);
  fail_unless(on[0].begin == -lead && on[0].end == 24s - lead);
  fail_unless(on[1].begin >= 60s - lead && on[1].begin <= 64s);
  fail_unless(on[1].end == on[1].begin + 24s);
}

/// No cue of less than 200 ms begins. Here an earlier cue leaves `left` of the minute's 24 s.
CHECK_TEST(test_shortest_cue)
{
  for (const auto &[left, begins] : { std::pair(100ms, false), std::pair(199ms, false),
                                      std::pair(200ms, true), std::pair(300ms, true) }) {
    CommandPlanner planner(
        1, { .rate = 0, .compensation = Compensation::none, .limits = { .max_on_time = 0s } });
    planner.plan(0s, 33ms, std::vector<float>{ 1.0F });
    planner.silence(24s - left);
    const auto commands = planner.plan(30s, 33ms, std::vector<float>{ 1.0F });
    fail_unless(commands.size() == (begins ? 1 : 0));
    if (begins)
      fail_unless(commands[0].until - commands[0].due() == left);
    fail_unless(planner.limited().duty == (begins ? 0 : 1));
  }
}

/// After a cue has run out, a new one begins with the next rise from zero, not with the same level.
CHECK_TEST(test_new_event_after_a_cue_that_ran_out)
{
  CommandPlanner planner(1);
  const auto stretches = play_level(
      planner, 6s, [](Time time) { return time >= 2400ms && time < 2600ms ? 0.0F : 1.0F; });
  const Time lead = RiseTime()(0, 3.0);
  fail_unless(stretches.size() == 2);
  fail_unless(stretches[0].end == 2s - lead);
  fail_unless(stretches[1].begin == 2600ms - lead && stretches[1].end == 4600ms - lead);
}

/// The four strongest tactors of each block are on. Among equals those that are on stay on. Nothing
/// else is limited.
CHECK_TEST(test_the_strongest_win)
{
  const PlannerSettings settings{ .limits = { .max_on_time = 0s, .max_duty = 0, .max_active = 4 } };
  CommandPlanner planner(9, settings);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> level(-0.5F, 1.0F);
  std::map<int, double> volts;
  for (int block = 0; block < 2000; block++) {
    std::vector<float> levels(9);
    for (float &one : levels)
      one = std::max(level(random), 0.0F);
    for (const Command &command : planner.plan(block * 200ms, 33ms, levels))
      volts[command.tactor] = command.volts;
    std::vector<float> sorted = levels;
    std::ranges::sort(sorted, std::greater{});
    for (int i = 0; i < 9; i++) {
      const float one = levels[static_cast<std::size_t>(i)];
      const double expected = one >= sorted[3] && one >= 1.0F / 6 ? 3.0 * one : 0;
      fail_unless(std::abs(volts[i] - expected) < 1e-6, "block %d, tactor %d: %g V, not %g", block,
                  i, volts[i], expected);
    }
  }
  CommandPlanner equals(6, settings);
  const auto on_after = [&](Time time, const std::vector<float> &levels) {
    for (const Command &command : equals.plan(time, 33ms, levels))
      volts[command.tactor] = command.volts;
    std::string on;
    for (int i = 0; i < 6; i++)
      on += volts[i] > 0 ? '#' : '.';
    return on;
  };
  volts.clear();
  fail_unless(on_after(0s, { 0, 0, 1, 1, 1, 1 }) == "..####");
  fail_unless(on_after(200ms, { 1, 1, 1, 1, 1, 1 }) == "..####");
  fail_unless(on_after(400ms, { 1, 1, 1, 1, 1, 0.5F }) == "#.###.");
  fail_unless(equals.limited().number == 3); // two had to wait, one had to stop
}

/// A stronger cue begins in time: the weakest tactor whose level ends with its frame stops for it.
CHECK_TEST(test_weakest_stops_for_a_stronger_cue)
{
  CommandPlanner planner(4, { .limits = { .max_active = 2 } });
  planner.plan(0s, 33ms, std::vector<float>{ 0.5F, 0.7F, 0, 0 });
  const auto commands = planner.plan(1s, 33ms, std::vector<float>{ 0, 0, 1, 0 });
  const Time lead = RiseTime()(0, 3.0);
  fail_unless(commands.size() == 3);
  fail_unless(commands[0].tactor == 0 && commands[0].volts == 0 && commands[0].due() == 1s - lead);
  fail_unless(commands[1].tactor == 1 && commands[1].volts == 0 && commands[1].due() == 1s);
  fail_unless(commands[2].tactor == 2 && commands[2].due() == 1s - lead);
}

/// Seeking does not raise the allowance: time on before a seek still counts.
CHECK_TEST(test_seeks_do_not_raise_the_allowance)
{
  CommandPlanner planner(1, { .limits = { .max_on_time = 0s } });
  Chair chair(1);
  for (int seek = 0; seek < 40; seek++) {
    for (int frame = 0; frame < 60; frame++)
      chair.take(
          planner.plan(kThirty.frame(frame), kThirty.duration(frame), std::vector<float>{ 1.0F }));
    chair.silence(1900ms);
    planner.reset(1900ms);
    chair.restart(1900ms + planner.settings().max_lead);
  }
  fail_unless(fullest_minute(chair.stretches[0]) <= 24s);
  fail_unless(fullest_minute(chair.stretches[0]) >= 23s); // but nearly that
}

/// A seek before anything was due does not count as time on.
CHECK_TEST(test_seek_before_anything_was_due)
{
  CommandPlanner planner(1, { .limits = { .max_on_time = 0s } });
  planner.plan(0s, 33ms, std::vector<float>{ 1.0F });
  planner.reset(23s);
  for (int seek = 0; seek < 20; seek++) {
    planner.plan(0s, 33ms, std::vector<float>{ 1.0F });
    planner.reset(-1s);
  }
  const auto commands = planner.plan(0s, 33ms, std::vector<float>{ 1.0F });
  const Time lead = RiseTime()(0, 3.0);
  fail_unless(commands.size() == 1);
  fail_unless(commands[0].until - commands[0].due() == 24s - (23s + lead));
}

/// A change of limits applies to tactors that are on, from the next block.
CHECK_TEST(test_change_of_limits)
{
  PlannerSettings settings;
  CommandPlanner planner(2, settings);
  planner.plan(0s, 33ms, std::vector<float>{ 1, 0.5F });
  settings.limits.max_on_time = 700ms;
  planner.set_settings(settings);
  auto commands = planner.plan(200ms, 33ms, std::vector<float>{ 1, 0.5F });
  fail_unless(commands.size() == 2);
  const Time lead = RiseTime()(0, 3.0);
  fail_unless(commands[0].volts == 3.0 && commands[0].until == 700ms - lead);
  settings.limits.max_on_time = 100ms;
  settings.limits.max_active = 1;
  planner.set_settings(settings);
  commands = planner.plan(400ms, 33ms, std::vector<float>{ 1, 0.5F });
  fail_unless(commands.size() == 2 && commands[0].volts == 0 && commands[0].due() == 400ms
              && commands[1].volts == 0 && commands[1].due() == 400ms);
}

/// A kick (full voltage) brings a motor from rest to 90 % by the frame and no further. Without it
/// Eq. 1 takes up to 164 ms.
CHECK_TEST(test_kick_start)
{
  for (const float level : { 0.17F, 0.2F, 0.4F, 0.6F, 0.8F, 0.99F }) {
    CommandPlanner planner(1, unlimited({ .kick_start = true }));
    const auto commands = planner.plan(1s, 33ms, std::vector<float>{ level });
    const double volts = 3.0 * static_cast<double>(level);
    fail_unless(commands.size() == 2);
    fail_unless(commands[0].volts == 3.0 && commands[1].due() == 1s);
    fail_unless_near(commands[1].volts, volts, 1e-6);
    // The amplitude at full voltage, integrated in small steps: da/dt = k (3 V − a), 90 % after Eq.
    // 1's time.
    const double full = (241.9 - 175.7 * 3 + 38.86 * 9) / 1000;
    const double k = std::log(10.0) / full;
    double amplitude = 0;
    double time = 0;
    for (; amplitude < 0.9 * volts; time += 1e-6)
      amplitude += 1e-6 * k * (3.0 - amplitude);
    fail_unless_near(seconds(commands[0].lead), std::max(time, 0.010), 1e-5);
  }
  // No kick for full level or a turning motor. After a rest there is one again.
  CommandPlanner planner(1, unlimited({ .rate = 0, .kick_start = true }));
  fail_unless(planner.plan(0s, 33ms, std::vector<float>{ 1.0F }).size() == 1);
  fail_unless(planner.plan(1s, 33ms, std::vector<float>{ 0.5F }).size() == 1);
  fail_unless(planner.plan(2s, 33ms, std::vector<float>{ 0.7F }).size() == 1);
  fail_unless(planner.plan(3s, 33ms, std::vector<float>{ 0.0F }).size() == 1);
  fail_unless(planner.plan(3050ms, 33ms, std::vector<float>{ 0.3F }).size() == 1);
  fail_unless(planner.plan(4s, 33ms, std::vector<float>{ 0.0F }).size() == 1);
  fail_unless(planner.plan(5s, 33ms, std::vector<float>{ 0.3F }).size() == 2);
}

CHECK_MAIN(planner_limits)
