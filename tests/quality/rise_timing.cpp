// SPDX-License-Identifier: LGPL-2.1-or-later
//
// When did the vibration arrive? Reads command traces (tactorsink trace-location), drives a
// simulated motor per tactor with the commands as they were issued, and prints how far from its
// frame rising commands reached 90 % of their level: a row a trace, as Markdown.
// Usage: rise_timing commands.csv ...
#include "tactor/command_trace.h"
#include "tactor/motor_model.h"
#include "tools/film/or_throw.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <vector>

using tactor::IssuedCommand;
using tactor::Time;

namespace {

/// Milliseconds from a rising command's frame to 90 % of its level; NaN if the next command came
/// before: such rises are left out.
double
arrival_ms(const tactor::MotorModel &motor, const IssuedCommand &command, Time until)
{
  const double goal = 0.9 * command.command.volts;
  if (motor.amplitude(until) < goal)
    return std::numeric_limits<double>::quiet_NaN();
  Time before = command.issued;
  Time after = until;
  while (after - before > std::chrono::microseconds(1)) {
    const Time middle = before + (after - before) / 2;
    (motor.amplitude(middle) < goal ? before : after) = middle;
  }
  return std::chrono::duration<double, std::milli>(after - command.command.effect).count();
}

void
judge(const char *path)
{
  const std::vector<IssuedCommand> trace = or_throw(tactor::read_command_trace(path));
  std::map<int, tactor::MotorModel> motors;
  std::vector<double> arrivals;
  for (std::size_t i = 0; i < trace.size(); i++) {
    const IssuedCommand &command = trace[i];
    tactor::MotorModel &motor = motors[command.command.tactor];
    const bool rises = command.command.volts > motor.amplitude(command.issued) / 0.9;
    motor.set(command.issued, command.command.volts);
    if (!rises)
      continue;
    const auto next = std::find_if(
        trace.begin() + static_cast<std::ptrdiff_t>(i) + 1, trace.end(),
        [&](const IssuedCommand &other) { return other.command.tactor == command.command.tactor; });
    const Time until
        = next == trace.end() ? command.issued + std::chrono::seconds(2) : next->issued;
    const double arrival = arrival_ms(motor, command, until);
    if (!std::isnan(arrival))
      arrivals.push_back(arrival);
  }
  std::ranges::sort(arrivals);
  const auto within = std::ranges::count_if(arrivals, [](double ms) { return std::abs(ms) <= 10; });
  const auto at = [&](double share) {
    return arrivals[static_cast<std::size_t>(share * static_cast<double>(arrivals.size() - 1))];
  };
  std::printf("| %s | %zu |", std::filesystem::path(path).stem().c_str(), arrivals.size());
  if (arrivals.empty())
    std::printf(" – | – | – | – |\n");
  else
    std::printf(" %.1f ms | %.1f ms | %.1f ms | %.1f %% |\n", at(0.01), at(0.5), at(0.99),
                100.0 * static_cast<double>(within) / static_cast<double>(arrivals.size()));
}

} // namespace

int
main(int argc, char **argv)
{
  if (argc < 2) {
    std::fprintf(stderr, "usage: %s commands.csv ...\n", argv[0]);
    return 2;
  }
  std::printf("| trace | rises | p1 | p50 | p99 | within ± 10 ms |\n"
              "|---|---|---|---|---|---|\n");
  try {
    for (int i = 1; i < argc; i++)
      judge(argv[i]);
  } catch (const std::exception &e) {
    std::fprintf(stderr, "rise_timing: %s\n", e.what());
    return 1;
  }
  return 0;
}
