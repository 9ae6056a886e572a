// SPDX-License-Identifier: LGPL-2.1-or-later
#include "chair_options.h"

#include "pipeline.h"
#include "translation.h"

void
ChairOptions::fill(UserDefaults &defaults)
{
  defaults.fill("driver", driver);
  defaults.fill_of_driver("device", device);
  defaults.fill_of_driver("mapping", mapping);
  defaults.fill_of_driver("calibration", calibration);
  defaults.fill("intensity", intensity);
  defaults.fill("mute", mute);
  defaults.fill(chair::kDelay, delay);
}

std::array<GOptionEntry, 7>
ChairOptions::entries()
{
  return { {
      { "driver", 'd', 0, G_OPTION_ARG_STRING, &driver.value,
        N_("Driver of tactorsink (default: the user's, else auto)"), "NAME" },
      { "device", 0, 0, G_OPTION_ARG_STRING, &device.value, N_("Device of the driver"), "ID" },
      { "mapping", 0, 0, G_OPTION_ARG_STRING, &mapping.value,
        N_("Tactor of each cell, such as 2,1,0"), "TACTORS" },
      { "calibration", 0, 0, G_OPTION_ARG_FILENAME, &calibration.value,
        N_("Calibration file of tactor-calibrate"), "FILE" },
      { "intensity", 'i', 0, G_OPTION_ARG_DOUBLE, &intensity,
        N_("Factor on all vibration, 0 to 1 (default: 1)"), "FACTOR" },
      { "trace", 0, 0, G_OPTION_ARG_FILENAME, &trace.value,
        N_("Write all commands to this CSV file"), "FILE" },
      {},
  } };
}

void
ChairOptions::check(UserDefaults &defaults) const
{
  expect_range("--intensity", intensity, 0, 1);
  defaults.keep_to_driver(driver.text());
}

std::string
ChairOptions::sink_line() const
{
  const auto text = [](gdouble number) -> std::string {
    std::array<char, G_ASCII_DTOSTR_BUF_SIZE> digits{};
    return g_ascii_dtostr(digits.data(), static_cast<gint>(digits.size()), number);
  };
  std::string line = "tactorsink rate=0 driver=" + launch_value(driver.text())
                     + " intensity=" + text(intensity) + " delay=" + text(delay);
  const auto add = [&line](const char *property, const TextOption &option) {
    if (option.is_set())
      line += std::string(" ") + property + "=" + launch_value(option.text());
  };
  if (mute)
    line += " mute=true";
  add("device", device);
  add("mapping", mapping);
  add("calibration", calibration);
  add("trace-location", trace);
  return line;
}
