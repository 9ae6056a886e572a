// SPDX-License-Identifier: LGPL-2.1-or-later
#include "study/timing.h"

#include "tactor/command_trace.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace study {

tl::expected<Timing, std::string>
read_timing(const std::string &trace)
{
  constexpr double kLate = 5; // ms, as tactorsink counts
  const auto commands = tactor::read_command_trace(trace);
  if (!commands)
    return tl::unexpected(commands.error());
  std::vector<double> errors;
  Timing timing;
  for (const tactor::IssuedCommand &one : *commands) {
    const std::chrono::duration<double, std::milli> error = one.issued - one.command.due();
    errors.push_back(error.count());
    timing.late += error.count() > kLate ? 1 : 0;
  }
  if (errors.empty())
    return timing;
  std::ranges::sort(errors);
  const auto rank = [&](double share) { // the nearest rank
    const double position = std::ceil(share * static_cast<double>(errors.size()));
    return errors[static_cast<std::size_t>(std::max(position, 1.0)) - 1];
  };
  timing.commands = static_cast<std::int64_t>(errors.size());
  timing.p50 = rank(0.5);
  timing.p99 = rank(0.99);
  timing.max = errors.back();
  return timing;
}

} // namespace study
