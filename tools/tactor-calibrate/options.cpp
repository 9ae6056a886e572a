// SPDX-License-Identifier: LGPL-2.1-or-later
#include "options.h"

#include "calibration/calibration.h"
#include "film/device_list.h"
#include "film/or_throw.h"
#include "text.h"
#include "translation.h"

#include <algorithm>
#include <cmath>
#include <csignal>

using visuotactile::read_number;

namespace {

std::atomic<bool> interrupted{ false };

void
interrupt(int)
{
  interrupted = true;
}

} // namespace

std::vector<GOptionEntry>
PlayOptions::with(std::initializer_list<GOptionEntry> own)
{
  defaults.fill("driver", driver);
  defaults.fill_of_driver("device", device);
  std::vector<GOptionEntry> entries{
    { "driver", 'd', 0, G_OPTION_ARG_STRING, &driver.value,
      N_("Driver of tactorsink, or audio for shakers at a sound card (default: the user's, else "
         "auto)"),
      "NAME" },
    { "device", 0, 0, G_OPTION_ARG_STRING, &device.value,
      N_("Device of the driver, or the name of a sound card"), "ID" },
    { "channels", 0, 0, G_OPTION_ARG_INT, &channels,
      N_("With --driver=audio: channels of the sound card; each is a tactor (default: 2)"), "N" },
    { "frequency", 0, 0, G_OPTION_ARG_STRING, &frequency.value,
      N_("With --driver=audio: carrier of each channel in Hz, such as 40,60 (default: 60)"),
      "LIST" },
    { "source", 's', 0, G_OPTION_ARG_STRING, &source.value,
      N_("GStreamer source that records the motors, as a launch line (default: autoaudiosrc); "
         "simulator: simulate motors and record them; none: record nothing"),
      "LINE" },
    { "simulated-motors", 0, 0, G_OPTION_ARG_FILENAME, &simulated_motors.value,
      N_("Calibration of the motors that --source=simulator has (default: the paper's)"), "FILE" },
  };
  entries.insert(entries.end(), own);
  entries.emplace_back();
  return entries;
}

PlayerSettings
PlayOptions::settings(double volts_max)
{
  defaults.keep_to_driver(driver.text());
  if (source.text() != "simulator")
    defaults.print(driver.text("auto"));
  PlayerSettings settings{ .driver = driver.text(),
                           .device = device.text(),
                           .volts_max = volts_max,
                           .channels = channels,
                           .frequency = frequency.text(),
                           .source = source.text() == "none" ? "" : source.text() };
  expect_range("--channels", channels, 1, 64);
  if (settings.driver == kAudio && settings.source == "simulator")
    throw UsageError(_("--source=simulator has motors of its own; leave out --driver=audio"));
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

std::vector<int>
parse_tactors(const std::string &text)
{
  std::vector<int> tactors;
  g_auto(GStrv) parts = g_strsplit(text.c_str(), ",", -1);
  for (gchar **part = parts; *part; part++) {
    g_auto(GStrv) ends = g_strsplit(*part, "-", 2);
    const int first = ends[0] ? read_number<int>(ends[0]).value_or(-1) : -1;
    const int last = ends[0] && ends[1] ? read_number<int>(ends[1]).value_or(-1) : first;
    if (first < 0 || last < first || last >= 4096) {
      tactors.clear();
      break;
    }
    for (int tactor = first; tactor <= last; tactor++)
      tactors.push_back(tactor);
  }
  if (tactors.empty())
    throw UsageError(in_text("expected tactors as in 0,2,5 or 0-8, got '{}'", text));
  return tactors;
}

tactor::Band
parse_band(const std::string &text)
{
  if (text.empty())
    return { 0, 0 };
  const std::size_t colon = std::min(text.find(':'), text.size());
  const auto low = read_number<double>(std::string_view(text).substr(0, colon));
  const auto high
      = read_number<double>(std::string_view(text).substr(std::min(colon + 1, text.size())));
  if (!low || !high || !(*low > 0 && *high > *low && std::isfinite(*high)))
    throw UsageError(in_text("expected a band as in 20:200, in Hz, got '{}'", text));
  return { *low, *high };
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
