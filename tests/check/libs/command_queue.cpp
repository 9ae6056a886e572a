// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/command_queue.h"

#include <algorithm>
#include <optional>
#include <random>
#include <vector>

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;

namespace {

Command
command(Time due, int tactor, double volts, Time lead = 0ns)
{
  return { .effect = due + lead, .lead = lead, .tactor = tactor, .volts = volts };
}

void
push(CommandQueue &queue, const std::vector<Command> &commands)
{
  queue.push(commands);
}

std::vector<double>
levels(const CommandQueue &queue)
{
  return { queue.levels().begin(), queue.levels().end() };
}

/// Reference implementation of the queue: an unsorted list that is searched for the earliest
/// command.
struct ReferenceQueue
{
  std::vector<Command> commands; ///< in order of arrival
  std::vector<double> volts;
  std::size_t coalesced = 0;

  std::optional<std::size_t> earliest() const
  {
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < commands.size(); i++)
      if (!found || commands[i].due() < commands[*found].due())
        found = i;
    return found;
  }

  std::vector<Command> take(Time now)
  {
    std::vector<Command> taken;
    for (auto next = earliest(); next && commands[*next].due() <= now; next = earliest()) {
      const Command one = commands[*next];
      commands.erase(commands.begin() + static_cast<std::ptrdiff_t>(*next));
      coalesced
          += std::erase_if(taken, [&](const Command &other) { return other.tactor == one.tactor; });
      taken.push_back(one);
      volts[static_cast<std::size_t>(one.tactor)] = one.volts;
    }
    return taken;
  }
};

} // namespace

CHECK_TEST(test_empty)
{
  CommandQueue queue(3);
  fail_unless(queue.size() == 0);
  fail_unless(queue.next_due() == std::nullopt);
  fail_unless(queue.take_due(Time::max()).empty());
  fail_unless(levels(queue) == std::vector<double>(3, 0.0));
  fail_unless(queue.clear() == 0);
  push(queue, {});
  fail_unless(queue.size() == 0);
  fail_unless(CommandQueue(0).levels().empty());
  fail_unless(CommandQueue(-1).levels().empty());
}

CHECK_TEST(test_order_of_due_times)
{
  CommandQueue queue(4);
  // The command with the earliest effect has the latest due time.
  push(queue, { command(30ms, 0, 1), command(20ms, 1, 2, 100ms), command(25ms, 2, 3, 50ms) });
  push(queue, { command(10ms, 3, 0.5, 500ms) });
  fail_unless(queue.size() == 4);
  fail_unless(queue.next_due() == Time(10ms));
  fail_unless(queue.take_due(10ms - 1ns).empty());
  fail_unless(queue.take_due(10ms) == (std::vector<Command>{ command(10ms, 3, 0.5, 500ms) }));
  fail_unless(levels(queue) == (std::vector<double>{ 0, 0, 0, 0.5 }));
  fail_unless(queue.next_due() == Time(20ms));
  fail_unless(queue.take_due(1s)
              == (std::vector<Command>{ command(20ms, 1, 2, 100ms), command(25ms, 2, 3, 50ms),
                                        command(30ms, 0, 1) }));
  fail_unless(levels(queue) == (std::vector<double>{ 1, 2, 3, 0.5 }));
  fail_unless(queue.size() == 0 && queue.coalesced() == 0);
}

CHECK_TEST(test_latest_wins)
{
  CommandQueue queue(2);
  push(queue,
       { command(10ms, 0, 1), command(20ms, 1, 1), command(30ms, 0, 2), command(50ms, 0, 3) });
  fail_unless(queue.take_due(40ms)
              == (std::vector<Command>{ command(20ms, 1, 1), command(30ms, 0, 2) }));
  fail_unless(queue.coalesced() == 1);
  fail_unless(levels(queue) == (std::vector<double>{ 2, 1 }));
  // Of two commands for the same time, the later one wins.
  push(queue, { command(50ms, 0, 0.7), command(50ms, 0, 0) });
  fail_unless(queue.take_due(50ms) == (std::vector<Command>{ command(50ms, 0, 0) }));
  fail_unless(queue.coalesced() == 3);
  fail_unless(levels(queue) == (std::vector<double>{ 0, 1 }));
}

CHECK_TEST(test_expiry)
{
  CommandQueue queue(3);
  const auto until = [](Command one, Time end) {
    one.until = end;
    return one;
  };
  push(queue, { until(command(10ms, 0, 1), 30ms), until(command(10ms, 1, 2), 40ms) });
  fail_unless(queue.next_due() == Time(10ms));
  fail_unless(queue.take_due(10ms).size() == 2);
  fail_unless(queue.next_due() == Time(30ms) && queue.size() == 0);
  fail_unless(queue.take_due(30ms - 1ns).empty());
  fail_unless(queue.take_due(30ms) == (std::vector<Command>{ command(30ms, 0, 0) }));
  fail_unless(levels(queue) == (std::vector<double>{ 0, 2, 0 }));
  // The same command afterwards is redundant. One at another time is not.
  push(queue, { command(30ms, 0, 0) });
  fail_unless(queue.size() == 0);
  push(queue, { command(31ms, 0, 0) });
  fail_unless(queue.take_due(31ms) == (std::vector<Command>{ command(31ms, 0, 0) }));
  // A command before the end brings an end of its own, or none.
  push(queue, { until(command(35ms, 1, 1.5), 60ms) });
  fail_unless(queue.take_due(35ms).size() == 1);
  fail_unless(queue.next_due() == Time(60ms));
  push(queue, { command(50ms, 1, 1) });
  fail_unless(queue.take_due(1s) == (std::vector<Command>{ command(50ms, 1, 1) }));
  fail_unless(!queue.next_due());
  // Taken late: the first command has expired, the others have not.
  push(queue, { until(command(2s, 0, 1), 2100ms), until(command(2s, 1, 1), 2300ms),
                command(2050ms, 2, 1) });
  fail_unless(queue.take_due(2200ms).size() == 3);
  fail_unless(levels(queue) == (std::vector<double>{ 0, 1, 1 }));
  fail_unless(queue.next_due() == Time(2300ms));
  queue.clear();
  fail_unless(!queue.next_due());
}

CHECK_TEST(test_clear)
{
  CommandQueue queue(2);
  push(queue, { command(10ms, 0, 1), command(10ms, 0, 2), command(20ms, 1, 3) });
  queue.take_due(10ms);
  push(queue, { command(30ms, 0, 1) });
  fail_unless(queue.clear() == 2);
  fail_unless(queue.size() == 0 && !queue.next_due());
  fail_unless(levels(queue) == (std::vector<double>{ 0, 0 }));
  fail_unless(queue.coalesced() == 1);
  fail_unless(queue.take_due(Time::max()).empty());
}

CHECK_TEST(test_missing_tactors)
{
  CommandQueue queue(2);
  push(queue, { command(0ms, -1, 1), command(0ms, 2, 1), command(0ms, 1, 1), command(0ms, 4096, 1),
                command(0ms, G_MININT, 1), command(0ms, G_MAXINT, 1) });
  fail_unless(queue.size() == 1);
  fail_unless(queue.take_due(0ms) == (std::vector<Command>{ command(0ms, 1, 1) }));
  CommandQueue none(0);
  push(none, { command(0ms, 0, 1) });
  fail_unless(none.size() == 0);
}

CHECK_TEST(test_against_reference)
{
  constexpr int kTactors = 5;
  std::mt19937 random(1);
  const auto dice = [&random](int sides) {
    return std::uniform_int_distribution<int>(0, sides - 1)(random);
  };
  CommandQueue queue(kTactors);
  ReferenceQueue reference;
  reference.volts.assign(kTactors, 0.0);
  Time now = 0s;
  for (int turn = 0; turn < 5000; turn++) {
    std::vector<Command> commands;
    for (int i = dice(5); i > 0; i--)
      commands.push_back(command(now + dice(30) * 1ns - 5ns, dice(kTactors + 2) - 1,
                                 dice(30) / 10.0, dice(10) * 10ms));
    queue.push(commands);
    std::ranges::copy_if(commands, std::back_inserter(reference.commands), [](const Command &one) {
      return one.tactor >= 0 && one.tactor < kTactors;
    });
    now += dice(10) * 1ns;
    if (dice(100) == 0) {
      fail_unless(queue.clear() == reference.commands.size());
      reference.commands.clear();
      reference.volts.assign(kTactors, 0.0);
    }
    const auto next = reference.earliest();
    fail_unless(queue.next_due()
                == (next ? std::optional<Time>(reference.commands[*next].due()) : std::nullopt));
    fail_unless(queue.take_due(now) == reference.take(now), "turn %d", turn);
    fail_unless(queue.size() == reference.commands.size());
    fail_unless(queue.coalesced() == reference.coalesced);
    fail_unless(levels(queue) == reference.volts);
  }
  fail_unless(reference.coalesced > 100);
}

CHECK_MAIN(command_queue)
