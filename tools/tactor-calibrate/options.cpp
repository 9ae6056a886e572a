// SPDX-License-Identifier: LGPL-2.1-or-later
#include "options.h"
#include "../or_throw.h"

#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <stdexcept>

namespace {

std::atomic<bool> interrupted{ false };

void
interrupt(int)
{
  interrupted = true;
}

bool
parse_number(const std::string &text, double &value)
{
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

} // namespace

std::vector<GOptionEntry>
PlayOptions::entries()
{
  return {
    { "driver", 'd', 0, G_OPTION_ARG_STRING, &driver.value, "As tactorsink's (default: auto)",
      "NAME" },
    { "device", 0, 0, G_OPTION_ARG_STRING, &device.value, "As tactorsink's: which board", "ID" },
    { "source", 's', 0, G_OPTION_ARG_STRING, &source.value,
      "Launch line of the GStreamer source that hears the motors (default: autoaudiosrc); "
      "simulator: "
      "simulated motors are heard; none: nothing is recorded",
      "LINE" },
    { "simulated-motors", 0, 0, G_OPTION_ARG_FILENAME, &simulated_motors.value,
      "Calibration whose motors source=simulator has (default: the paper's)", "FILE" },
  };
}

PlayerSettings
PlayOptions::settings(double volts_max) const
{
  PlayerSettings settings{ .driver = driver.text(),
                           .device = device.text(),
                           .volts_max = volts_max,
                           .source = source.text() == "none" ? "" : source.text() };
  settings.sensor.noise = 0.001;
  if (!simulated_motors.is_set())
    return settings;
  const tactor::Calibration simulated = or_throw(tactor::read_calibration(simulated_motors.text()));
  settings.motors = simulated.motors(volts_max);
  settings.sensor.gains.assign(settings.motors.size(), 1.0);
  for (const auto &[index, tactor] : simulated.tactors)
    if (!tactor.vibration.empty())
      settings.sensor.gains[static_cast<std::size_t>(index)] = tactor.vibration.back().amplitude
                                                               / tactor.vibration.back().volts
                                                               / settings.sensor.gain;
  return settings;
}

bool
parse_options(int argc, char **argv, const char *arguments_name, const char *summary,
              std::vector<GOptionEntry> entries, const std::array<GOptionEntry, 3> &manner,
              std::vector<std::string> &arguments)
{
  g_auto(GStrv) rest = nullptr;
  entries.push_back(
      { G_OPTION_REMAINING, 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &rest, nullptr, arguments_name });
  entries.push_back({});
  g_autoptr(GOptionContext) context = g_option_context_new(nullptr);
  g_option_context_set_summary(context, summary);
  g_option_context_add_main_entries(context, entries.data(), nullptr);
  g_option_context_add_main_entries(context, manner.data(), nullptr);
  g_autoptr(GError) error = nullptr;
  if (!g_option_context_parse(context, &argc, &argv, &error)) {
    std::fprintf(stderr, "tactor-calibrate: %s\n", error->message);
    return false;
  }
  for (gchar **argument = rest; argument && *argument; argument++)
    arguments.emplace_back(*argument);
  return true;
}

std::vector<int>
parse_tactors(const std::string &text)
{
  std::vector<int> tactors;
  const auto fail = [&] {
    throw std::runtime_error("expected tactors as in 0,2,5 or 0-8, got '" + text + "'");
  };
  g_auto(GStrv) parts = g_strsplit(text.c_str(), ",", -1);
  for (gchar **part = parts; *part; part++) {
    g_auto(GStrv) ends = g_strsplit(*part, "-", 2);
    double first = 0;
    if (!ends[0] || !parse_number(ends[0], first))
      fail();
    double last = first;
    if (ends[1] && !parse_number(ends[1], last))
      fail();
    if (first < 0 || last < first || last >= 4096)
      fail();
    for (int tactor = static_cast<int>(first); tactor <= static_cast<int>(last); tactor++)
      tactors.push_back(tactor);
  }
  if (tactors.empty())
    fail();
  return tactors;
}

tactor::Band
parse_band(const std::string &text)
{
  if (text.empty())
    return { 0, 0 };
  g_auto(GStrv) ends = g_strsplit(text.c_str(), ":", 2);
  tactor::Band band{ 0, 0 };
  if (!ends[0] || !ends[1] || !parse_number(ends[0], band.low_hz)
      || !parse_number(ends[1], band.high_hz) || !(band.low_hz > 0 && band.high_hz > band.low_hz))
    throw std::runtime_error("expected a band as in 20:200, in Hz, got '" + text + "'");
  return band;
}

const std::atomic<bool> &
interruption()
{
  static const bool installed = [] {
    struct sigaction action = {};
    action.sa_handler = interrupt;
    return sigaction(SIGINT, &action, nullptr) == 0 && sigaction(SIGTERM, &action, nullptr) == 0;
  }();
  (void)installed;
  return interrupted;
}
