// SPDX-License-Identifier: LGPL-2.1-or-later
#include "commands.h"

#include "chair/settings.h"
#include "film/command_line.h"
#include "film/motor_walk.h"
#include "film/pipeline.h"
#include "translation.h"

#include <gst/gst.h>

#include <cstdio>
#include <stdexcept>

namespace {

/// Applies the settings that are properties of tactorsink, except mute.
void
apply(GstElement *tactors, const chair::Settings &settings)
{
  for (const auto &[key, value] : settings.values) {
    GParamSpec *spec = g_object_class_find_property(G_OBJECT_GET_CLASS(tactors), key.c_str());
    if (spec == nullptr || key == "mute")
      continue;
    if (spec->value_type == G_TYPE_STRING) // as it is: a device's name may begin with a quote
      g_object_set(tactors, key.c_str(), value.c_str(), nullptr);
    else
      gst_util_set_object_arg(G_OBJECT(tactors), key.c_str(), value.c_str());
  }
}

} // namespace

int
test(int argc, char **argv)
{
  TextOption driver;
  CommonOptions common;
  const GOptionEntry entries[]
      = { { "driver", 'd', 0, G_OPTION_ARG_STRING, &driver.value,
            N_("Driver of the tactors (default: from the settings)"), "NAME" },
          {} };
  parse_options(
      argc, argv, entries, common,
      { .arguments = "",
        .summary = N_("Drives one tactor after the other for half a second, with the settings of "
                      "all\nprograms, row by row from the top left, or each motor of a gamepad, a "
                      "vest or a device of\nIntiface. Prints the name of each."),
        .least = 0,
        .most = 0 });
  gst_init(nullptr, nullptr);
  chair::Settings settings = chair::read_settings();
  settings.leave_out_shakers();
  for (const std::string &complaint : settings.complaints)
    print_error("visuotactile-settings", complaint);
  if (driver.is_set())
    settings.values["driver"] = driver.text();
  const auto set = settings.values.find(chair::kGrid);
  const chair::Grid grid
      = set == settings.values.end() ? chair::Grid{ 3, 3 } : chair::parse_grid(set->second);

  const Owned<GstElement> tactors(gst_element_factory_make("tactorsink", nullptr));
  if (tactors == nullptr)
    throw std::runtime_error(_("GStreamer has no element 'tactorsink'; install the project"));
  gst_object_ref_sink(tactors.get());
  apply(tactors.get(), settings);
  g_autofree gchar *driver_name = nullptr;
  g_autofree gchar *device = nullptr;
  g_object_get(tactors.get(), "driver", &driver_name, "device", &device, nullptr);
  walk(
      tactors.get(), walk_of_device(driver_name, device ? device : "", grid.rows, grid.columns),
      [&](const std::string &motor) {
        if (common.quiet)
          return;
        std::printf("%s\n", motor.c_str());
        std::fflush(stdout);
      },
      [](const std::string &warning) { print_error("visuotactile-settings", warning); });
  return motors_may_run(tactors.get()) ? 1 : 0;
}
