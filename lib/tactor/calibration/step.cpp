// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/calibration/step.h"

#include <algorithm>
#include <map>

namespace tactor {

namespace {

/// A stretch of time at one voltage.
struct Stretch
{
  double volts = 0;
  Time begin{ 0 };
  Time effect{ 0 };
  Time end{ 0 };
};

/// What one tactor was told, from before the first command to the end.
std::vector<Stretch>
stretches_of(std::span<const IssuedCommand> trace, int tactor, Time end)
{
  std::vector<Stretch> stretches{ { .begin = trace.front().issued - std::chrono::seconds(1) } };
  for (const IssuedCommand &issued : trace) {
    if (issued.command.tactor != tactor || issued.command.volts == stretches.back().volts)
      continue;
    stretches.back().end = issued.issued;
    stretches.push_back(
        { .volts = issued.command.volts, .begin = issued.issued, .effect = issued.command.effect });
  }
  stretches.back().end = std::max(end, stretches.back().begin);
  return stretches;
}

/// Rests are only where no other tactor can be heard either.
void
listen_apart(Step &step, const Stretch &other)
{
  const Time begin = std::min(step.rest_end, step.at);
  if (other.begin < step.end && other.end > begin)
    step.overlapped = true;
  else if (other.end <= begin)
    step.rest_begin = std::max(step.rest_begin, other.end);
  else
    step.next = std::min(step.next, std::max(other.begin, step.off));
}

} // namespace

std::vector<Step>
steps_of(std::span<const IssuedCommand> trace, Time end, Time hold)
{
  std::map<int, std::vector<Stretch>> tactors;
  for (const IssuedCommand &issued : trace)
    if (!tactors.contains(issued.command.tactor))
      tactors[issued.command.tactor] = stretches_of(trace, issued.command.tactor, end);

  std::vector<Step> steps;
  for (const auto &[tactor, stretches] : tactors) {
    Stretch rest = stretches.front();
    for (std::size_t i = 1; i < stretches.size(); i++) {
      const Stretch &before = stretches[i - 1];
      const Stretch &now = stretches[i];
      if (before.volts == 0)
        rest = before;
      const bool was_held = before.volts == 0 || before.end - before.begin >= hold;
      if (now.volts == 0 || !was_held || now.end - now.begin < hold)
        continue;
      Step step{ .tactor = tactor,
                 .start_volts = before.volts,
                 .target_volts = now.volts,
                 .rest_begin = rest.begin,
                 .rest_end = rest.end,
                 .at = now.begin,
                 .effect = now.effect,
                 .end = now.end,
                 .off = now.end,
                 .next = now.end };
      if (i + 1 < stretches.size() && stretches[i + 1].volts == 0)
        step.next = stretches[i + 1].end;
      steps.push_back(step);
    }
  }
  for (Step &step : steps)
    for (const auto &[tactor, stretches] : tactors)
      for (const Stretch &other : stretches)
        if (tactor != step.tactor && other.volts > 0)
          listen_apart(step, other);
  std::ranges::sort(steps, {}, &Step::at);
  return steps;
}

} // namespace tactor
