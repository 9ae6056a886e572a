// SPDX-License-Identifier: LGPL-2.1-or-later
#include "calibration/step.h"

#include <algorithm>
#include <iterator>
#include <map>

namespace tactor {

namespace {

/// A time at one voltage.
struct Stretch
{
  double volts = 0;
  Time begin{ 0 };
  Time effect{ 0 };
  Time end{ 0 };
};

/// The voltages of each tactor, from before the first command to the end.
std::map<int, std::vector<Stretch>>
stretches_of(std::span<const IssuedCommand> trace, Time end)
{
  std::map<int, std::vector<Stretch>> tactors;
  for (const IssuedCommand &issued : trace) {
    std::vector<Stretch> &stretches = tactors[issued.command.tactor];
    if (stretches.empty())
      stretches.push_back({ .begin = trace.front().issued - std::chrono::seconds(1) });
    if (issued.command.volts == stretches.back().volts)
      continue;
    stretches.back().end = issued.issued;
    stretches.push_back(
        { .volts = issued.command.volts, .begin = issued.issued, .effect = issued.command.effect });
  }
  for (auto &[tactor, stretches] : tactors)
    stretches.back().end = std::max(end, stretches.back().begin);
  return tactors;
}

/// Shortens the rests of a step to times without vibration of another tactor.
void
keep_apart(Step &step, const Stretch &other)
{
  const Time begin = std::min(step.rest_end, step.at);
  if (other.begin < step.end && other.end > begin)
    step.overlapped = true;
  else if (other.end <= begin)
    step.rest_begin = std::max(step.rest_begin, other.end);
  else
    step.next = std::min(step.next, std::max(other.begin, step.off));
}

/// The same for all stretches of another tactor. Only the nearest matter: the last before the step,
/// the first during it, the first after it.
void
keep_apart(Step &step, const std::vector<Stretch> &others)
{
  const Time begin = std::min(step.rest_end, step.at);
  const auto is_on = [](const Stretch &stretch) {
    return stretch.volts > 0;
  };
  const auto during = std::ranges::partition_point(
      others, [&](const Stretch &other) { return other.end <= begin; });
  const auto after = std::partition_point(
      during, others.end(), [&](const Stretch &other) { return other.begin < step.end; });
  const auto last = std::find_if(std::make_reverse_iterator(during), others.rend(), is_on);
  if (last != others.rend())
    keep_apart(step, *last);
  if (const auto first = std::find_if(during, after, is_on); first != after)
    keep_apart(step, *first);
  if (const auto first = std::find_if(after, others.end(), is_on); first != others.end())
    keep_apart(step, *first);
}

} // namespace

std::vector<Step>
steps_of(std::span<const IssuedCommand> trace, Time end, Time hold)
{
  const std::map<int, std::vector<Stretch>> tactors = stretches_of(trace, end);
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
      if (tactor != step.tactor)
        keep_apart(step, stretches);
  std::ranges::sort(steps, {}, &Step::at);
  return steps;
}

} // namespace tactor
