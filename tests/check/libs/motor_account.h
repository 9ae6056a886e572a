// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What motors do under commands: a model that knows nothing of limits.
#pragma once

#include "tactor/command_planner.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <utility>
#include <vector>

using namespace std::chrono_literals;
using namespace tactor;

struct Stretch
{
  Time begin;
  Time end;
};

inline double
seconds(Time time)
{
  return std::chrono::duration<double>(time).count();
}

/// A chair that obeys commands and records when each motor was on. Its time axis continues when
/// running time restarts.
class Chair
{
public:
  explicit Chair(int tactors) : stretches(static_cast<std::size_t>(tactors))
  {
  }

  void take(const std::vector<Command> &commands)
  {
    for (const Command &command : commands)
      pending_[command.tactor].push_back(command);
  }

  /// Carries out all that is due before running time `time`.
  void run_to(Time time)
  {
    for (auto &[tactor, commands] : pending_) {
      for (const Command &command : commands)
        if (command.due() < time)
          tell(tactor, command.due(), command.volts, command.until);
      std::erase_if(commands, [&](const Command &command) { return command.due() < time; });
      State &state = states_[tactor];
      if (state.on && state.until <= time)
        tell(tactor, state.until, 0, Time::max());
    }
  }

  /// Motors stop at running time `time`, and commands that are not due yet are dropped.
  void silence(Time time)
  {
    run_to(time);
    for (auto &[tactor, commands] : pending_) {
      commands.clear();
      tell(tactor, time, 0, Time::max());
    }
  }

  /// Running time restarts at 0, this much later on the chair's time axis.
  void restart(Time by)
  {
    origin_ += by;
  }

  std::vector<std::vector<Stretch>> stretches; ///< of each tactor, in order
  int commands_after_end = 0;

private:
  struct State
  {
    bool on = false;
    Time since{ 0 };
    Time until = Time::max();
  };

  void tell(int tactor, Time time, double volts, Time until)
  {
    State &state = states_[tactor];
    if (state.on && state.until <= time) {
      finish(tactor, state.until);
      state.on = false;
    }
    if (state.on && volts == 0)
      finish(tactor, time);
    if (!state.on && volts != 0)
      state.since = time;
    state.on = volts != 0;
    state.until = until;
  }
  void finish(int tactor, Time end)
  {
    const Time begin = states_[tactor].since;
    if (end > begin)
      stretches[static_cast<std::size_t>(tactor)].push_back({ origin_ + begin, origin_ + end });
  }

  std::map<int, std::vector<Command>> pending_;
  std::map<int, State> states_;
  Time origin_{ 0 };
};

/// The longest time on without a break of 100 ms. Shorter breaks are not counted as time on, since
/// a seek makes their length unknown.
inline Time
longest_cue(const std::vector<Stretch> &stretches)
{
  Time longest{ 0 };
  Time on{ 0 };
  for (std::size_t i = 0; i < stretches.size(); i++) {
    if (i == 0 || stretches[i].begin - stretches[i - 1].end >= 100ms)
      on = Time(0);
    on += stretches[i].end - stretches[i].begin;
    longest = std::max(longest, on);
  }
  return longest;
}

/// The longest total time on within any minute, which is one that ends with a stretch.
inline Time
fullest_minute(const std::vector<Stretch> &stretches)
{
  Time fullest{ 0 };
  for (const Stretch &last : stretches) {
    Time on{ 0 };
    for (const Stretch &one : stretches)
      on += std::max(std::min(one.end, last.end) - std::max(one.begin, last.end - 60s), Time(0));
    fullest = std::max(fullest, on);
  }
  return fullest;
}

/// The largest number on at the same time.
inline int
most_at_once(const std::vector<std::vector<Stretch>> &stretches)
{
  std::vector<std::pair<Time, int>> changes; // at equal times, ends sort first
  for (const auto &tactor : stretches)
    for (const Stretch &stretch : tactor) {
      changes.emplace_back(stretch.begin, 1);
      changes.emplace_back(stretch.end, -1);
    }
  std::ranges::sort(changes);
  int on = 0;
  int most = 0;
  for (const auto &[time, change] : changes) {
    on += change;
    most = std::max(most, on);
  }
  return most;
}
