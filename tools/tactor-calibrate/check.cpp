// SPDX-License-Identifier: LGPL-2.1-or-later
#include "commands.h"
#include "options.h"
#include "session.h"
#include "translation.h"

#include <gst/gst.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <stdexcept>
#include <string>

using namespace std::chrono_literals;
using tactor::Time;

namespace {

constexpr Time kOn = 800ms;

/// Each tactor in turn at random levels from a fixed seed.
std::vector<Frame>
pattern(const std::vector<int> &tactors, int events)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<float> level(0.3F, 1.0F);
  const auto columns = static_cast<std::size_t>(*std::ranges::max_element(tactors)) + 1;
  // Keeps a tactor's duty below 0.4.
  const Time off = std::max(700ms + 0ns, Time(std::llround(static_cast<double>(kOn.count()) / 0.35
                                                           / static_cast<double>(tactors.size())))
                                             - kOn);
  std::vector<Frame> frames{ { .duration = 1s, .levels = std::vector<float>(columns) } };
  const auto add = [&](Time duration, int tactor, float value) {
    Frame frame{ .begin = frames.back().begin + frames.back().duration,
                 .duration = duration,
                 .levels = std::vector<float>(columns) };
    frame.levels[static_cast<std::size_t>(tactor)] = value;
    frames.push_back(std::move(frame));
  };
  for (int event = 0; event < events; event++)
    for (const int tactor : tactors) {
      add(kOn, tactor, level(random));
      for (Time rest{ 0 }; rest < off; rest += 1s) // a map lasts a second at most
        add(std::min(Time(1s), off - rest), tactor, 0);
    }
  return frames;
}

void
print(const char *what, std::vector<double> errors)
{
  std::ranges::sort(errors, {}, [](double error) { return std::abs(error); });
  double sum = 0;
  for (const double error : errors)
    sum += error;
  const auto at = [&](double share) {
    return std::abs(errors[static_cast<std::size_t>(
        std::ceil(share * static_cast<double>(errors.size())) - 1)]);
  };
  std::printf(_("%-10s %4zu rises: mean %+6.1f ms, |error| p50 %5.1f, p95 %5.1f, max %5.1f ms\n"),
              what, errors.size(), sum / static_cast<double>(errors.size()), at(0.5), at(0.95),
              at(1));
}

} // namespace

int
check(int argc, char **argv)
{
  PlayOptions play_options;
  TextOption tactors("0");
  TextOption calibration;
  TextOption band;
  gint events = 10;
  gdouble volts_max = 3;
  CommonOptions common;
  const std::vector<GOptionEntry> entries = play_options.with({
      { "calibration", 'c', 0, G_OPTION_ARG_FILENAME, &calibration.value,
        N_("Calibration of the motors (default: the paper's motors)"), "FILE" },
      { "tactors", 't', 0, G_OPTION_ARG_STRING, &tactors.value,
        N_("Tactors to check, such as 0-8 or 0,2 (default: 0)"), "LIST" },
      { "events", 'n', 0, G_OPTION_ARG_INT, &events, N_("Rises of each tactor (default: 10)"),
        "N" },
      { "voltage-max", 0, 0, G_OPTION_ARG_DOUBLE, &volts_max,
        N_("Voltage at the motor for level 1 (default: 3)"), "V" },
      { "band", 'b', 0, G_OPTION_ARG_STRING, &band.value,
        N_("Band to filter, in Hz (default: detected)"), "LOW:HIGH" },
  });
  parse_options(
      argc, argv, entries.data(), common,
      { .arguments = "",
        .summary = N_("Plays a pattern and prints the timing errors of each tactor: from a frame "
                      "to the\nmoment at which the vibration has reached 90 % of its level."),
        .least = 0,
        .most = 0,
        .quiet_help = N_("Print only errors and the line for all tactors") });
  expect_range("--events", events, 1, 1000);
  gst_init(nullptr, nullptr);
  PlayerSettings player = play_options.settings(volts_max);
  if (player.source.empty())
    throw UsageError(_("--source=none has nothing to check"));
  player.calibration = calibration.text();
  player.compensate = true;
  const std::vector<int> list = parse_tactors(tactors.text());
  const Played played = play(pattern(list, events), player, interruption());
  const Session::Heard heard
      = measure_recording(played.recording, played.trace, *std::ranges::max_element(list) + 1,
                          parse_band(band.text()), false);

  std::map<int, std::vector<double>> errors;
  std::vector<double> all;
  std::map<std::string, int> refused;
  for (const tactor::StepResponse &response : heard.responses) {
    if (!response.step.rises())
      continue;
    if (response.fault != tactor::StepFault::none) {
      refused[std::string(tactor::fault_name(response.fault))]++;
      continue;
    }
    const double lead
        = static_cast<double>((response.step.effect - response.step.at).count()) / 1e6;
    errors[response.step.tactor].push_back(response.risen_ms - lead);
    all.push_back(response.risen_ms - lead);
  }
  if (all.empty())
    throw std::runtime_error(_("no rise could be measured; is the sensor on the motor?"));
  for (const auto &[tactor, own_errors] : errors)
    if (!common.quiet)
      print(("tactor " + std::to_string(tactor)).c_str(), own_errors);
  print("all", all);
  for (const auto &[fault, count] : refused)
    std::printf(_("%d rises could not be measured: %s\n"), count, fault.c_str());
  return 0;
}
