// SPDX-License-Identifier: LGPL-2.1-or-later
#include "commands.h"

#include "chair/settings.h"
#include "film/command_line.h"
#include "film/pipeline.h"

#include <gst/app/gstappsrc.h>
#include <gst/tactile/tactile.h>

#include <cstdio>

namespace {

/// Each cell is on in the first of these, and off in the second.
constexpr GstClockTime kOn = 500 * GST_MSECOND;
constexpr GstClockTime kOff = 250 * GST_MSECOND;

/// Gives tactorsink what it knows of the settings. It is not muted.
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

void
push(GstElement *source, const std::vector<gfloat> &levels, GstClockTime at, GstClockTime duration)
{
  GstBuffer *map = gst_tactile_map_buffer_new(levels.data(), levels.size());
  GST_BUFFER_PTS(map) = at;
  GST_BUFFER_DURATION(map) = duration;
  gst_app_src_push_buffer(GST_APP_SRC(source), map); // refused after an error, which the bus has
}

/// Throws std::runtime_error if there is an error. Returns whether it has ended.
bool
ended(GstBus *bus, GstClockTime patience)
{
  g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(
      bus, patience,
      static_cast<GstMessageType>(GST_MESSAGE_ERROR | GST_MESSAGE_WARNING | GST_MESSAGE_EOS));
  if (message == nullptr)
    return false;
  if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS)
    return true;
  g_autoptr(GError) error = nullptr;
  if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_WARNING) {
    gst_message_parse_warning(message, &error, nullptr);
    print_error("visuotactile-settings", error->message);
    return false;
  }
  gst_message_parse_error(message, &error, nullptr);
  throw std::runtime_error(error->message);
}

} // namespace

int
test(int argc, char **argv)
{
  TextOption driver;
  CommonOptions common;
  const GOptionEntry entries[] = { { "driver", 'd', 0, G_OPTION_ARG_STRING, &driver.value,
                                     "What drives the tactors (default: as set)", "NAME" },
                                   {} };
  parse_options(argc, argv, entries, common,
                { .arguments = "",
                  .summary = "Drives one tactor after the other for half a second, with the "
                             "settings of all\nprograms, row by row from the top left.",
                  .least = 0,
                  .most = 0,
                  .force_help = Usage::kWritesNothing });
  gst_init(nullptr, nullptr);
  chair::Settings settings = chair::read_settings();
  for (const std::string &complaint : settings.complaints)
    print_error("visuotactile-settings", complaint);
  if (driver.is_set())
    settings.values["driver"] = driver.text();
  const auto set = settings.values.find(chair::kGrid);
  const chair::Grid grid
      = set == settings.values.end() ? chair::Grid{ 3, 3 } : chair::parse_grid(set->second);

  const Pipeline pipeline = make_pipeline("appsrc name=maps format=time block=true max-buffers=2 ! "
                                          "tactorsink name=tactors");
  const Owned<GstElement> source = element(pipeline, "maps");
  const Owned<GstElement> tactors = element(pipeline, "tactors");
  apply(tactors.get(), settings);
  g_autoptr(GstCaps) caps = gst_tactile_map_caps_new(grid.rows, grid.columns, 4, 1);
  gst_app_src_set_caps(GST_APP_SRC(source.get()), caps);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline.get());
  if (gst_element_set_state(pipeline.get(), GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE)
    throw std::runtime_error(start_error(bus));

  GstClockTime at = 0;
  for (unsigned cell = 0; cell < grid.rows * grid.columns; cell++) {
    std::vector<gfloat> levels(std::size_t{ grid.rows } * grid.columns, 0);
    if (!common.quiet) {
      std::printf("row %u, column %u\n", cell / grid.columns + 1, cell % grid.columns + 1);
      std::fflush(stdout);
    }
    levels[cell] = 1;
    push(source.get(), levels, at, kOn);
    levels[cell] = 0;
    push(source.get(), levels, at + kOn, kOff);
    at += kOn + kOff;
    ended(bus, 0);
  }
  gst_app_src_end_of_stream(GST_APP_SRC(source.get()));
  while (!ended(bus, GST_CLOCK_TIME_NONE)) {
  }
  return 0;
}
