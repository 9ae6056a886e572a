// SPDX-License-Identifier: LGPL-2.1-or-later
#include "motor_walk.h"

#include "device_list.h"
#include "or_throw.h"
#include "pipeline.h"

#include "tactor/drivers/registry.h"
#include "translation.h"

#include <gst/app/gstappsrc.h>
#include <gst/tactile/tactile.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace {

/// Each motor is on in the first of these, and off in the second.
constexpr GstClockTime kOn = 500 * GST_MSECOND;
constexpr GstClockTime kOff = 250 * GST_MSECOND;

constexpr std::size_t kMostColumns = GST_TACTILE_MAX_SIDE;

void
push(GstElement *source, const std::vector<gfloat> &levels, GstClockTime at, GstClockTime duration)
{
  GstBuffer *map = gst_tactile_map_buffer_new(levels.data(), levels.size());
  GST_BUFFER_PTS(map) = at;
  GST_BUFFER_DURATION(map) = duration;
  gst_app_src_push_buffer(GST_APP_SRC(source), map); // refused after an error, which the bus has
}

/// The time until which the bus is listened to.
GstClockTime
patience(GstElement *pipeline, GstClockTime running_time)
{
  const Owned<GstClock> clock(gst_element_get_clock(pipeline));
  if (clock == nullptr)
    return 0;
  const GstClockTime now = gst_clock_get_time(clock.get()) - gst_element_get_base_time(pipeline);
  return running_time > now ? running_time - now : 0;
}

/// Listens to the bus until the end of the stream, true, or that running time. `info` becomes the
/// last information.
bool
ended(GstElement *pipeline, GstClockTime until,
      const std::function<void(const std::string &)> &warn, std::string &info)
{
  const Owned<GstBus> bus(gst_element_get_bus(pipeline));
  while (true) {
    const bool waits = GST_CLOCK_TIME_IS_VALID(until);
    g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(
        bus.get(), waits ? patience(pipeline, until) : GST_CLOCK_TIME_NONE,
        static_cast<GstMessageType>(GST_MESSAGE_ERROR | GST_MESSAGE_WARNING | GST_MESSAGE_INFO
                                    | GST_MESSAGE_LATENCY | GST_MESSAGE_EOS));
    if (message == nullptr)
      return false;
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS)
      return true;
    g_autoptr(GError) error = nullptr;
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_LATENCY) {
      gst_bin_recalculate_latency(GST_BIN(pipeline));
    } else if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_INFO) {
      gst_message_parse_info(message, &error, nullptr);
      info = error->message;
    } else if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_WARNING) {
      gst_message_parse_warning(message, &error, nullptr);
      warn(error->message);
    } else {
      gst_message_parse_error(message, &error, nullptr);
      throw std::runtime_error(error->message);
    }
  }
}

} // namespace

MotorWalk
walk_of_grid(unsigned rows, unsigned columns)
{
  MotorWalk motors{ .names = {}, .rows = rows, .columns = columns, .mapping = {} };
  for (unsigned cell = 0; cell < rows * columns; cell++)
    motors.names.push_back("row " + std::to_string(cell / columns + 1) + ", column "
                           + std::to_string(cell % columns + 1));
  return motors;
}

MotorWalk
walk_of_motors(const std::vector<std::string> &names)
{
  if (names.empty() || names.size() > kMostColumns * kMostColumns)
    throw std::runtime_error(
        in_text("expected 1 to 4096 motors, got {}", std::to_string(names.size())));
  const std::size_t columns = std::min(names.size(), kMostColumns);
  const std::size_t rows = (names.size() + columns - 1) / columns;
  MotorWalk motors{ .names = names,
                    .rows = static_cast<unsigned>(rows),
                    .columns = static_cast<unsigned>(columns),
                    .mapping = {} };
  for (std::size_t cell = 0; cell < rows * columns; cell++)
    motors.mapping += (cell == 0 ? "" : ",")
                      + (cell < names.size() ? std::to_string(cell) : std::string("-1"));
  return motors;
}

MotorWalk
walk_of_device(const std::string &driver, const std::string &device, unsigned rows,
               unsigned columns)
{
  const auto &all = tactor::drivers();
  const auto info = std::ranges::find(all, driver, &tactor::DriverInfo::name);
  if (info == all.end() || !info->names_motors)
    return walk_of_grid(rows, columns);
  const std::unique_ptr<tactor::Driver> opened = info->create();
  or_throw(opened->open({ .device = device }));
  const std::vector<std::string> names = opened->status().motors;
  opened->close();
  return walk_of_motors(names);
}

void
keep_motor(MotorWalk &motors, int only)
{
  if (only < 1 || static_cast<std::size_t>(only) > motors.names.size())
    throw std::runtime_error(in_text("expected a motor from 1 to {}, got {}",
                                     std::to_string(motors.names.size()), std::to_string(only)));
  for (std::size_t motor = 0; motor < motors.names.size(); motor++)
    if (motor + 1 != static_cast<std::size_t>(only))
      motors.names[motor].clear();
}

void
walk(GstElement *sink, const MotorWalk &motors,
     const std::function<void(const std::string &)> &show,
     const std::function<void(const std::string &)> &warn)
{
  const Pipeline pipeline(gst_pipeline_new(nullptr));
  const Owned<GstElement> source(gst_element_factory_make("appsrc", nullptr));
  if (source == nullptr)
    throw std::runtime_error(_("GStreamer has no element 'appsrc'; install its base plugins"));
  gst_object_ref_sink(source.get());
  g_object_set(source.get(), "format", GST_FORMAT_TIME, nullptr);
  gst_bin_add_many(GST_BIN(pipeline.get()), source.get(), sink, nullptr);
  gst_element_link(source.get(), sink);
  if (!motors.mapping.empty())
    g_object_set(sink, "mapping", motors.mapping.c_str(), nullptr);
  g_autoptr(GstCaps) caps = gst_tactile_map_caps_new(motors.rows, motors.columns, 4, 1);
  gst_app_src_set_caps(GST_APP_SRC(source.get()), caps);
  const Owned<GstBus> bus(gst_element_get_bus(pipeline.get()));
  if (gst_element_set_state(pipeline.get(), GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE)
    throw std::runtime_error(start_error(bus.get()));

  std::string info;
  std::vector<std::string> warnings; // of a device that is being opened
  const auto hold = [&](const std::string &warning) {
    warnings.push_back(warning);
  };
  std::vector<gfloat> levels(std::size_t{ motors.rows } * motors.columns, 0);
  push(source.get(), levels, 0, kOff);
  GstClockTime at = kOff;
  bool is_open = false;
  for (std::size_t motor = 0; motor < motors.names.size(); motor++) {
    if (motors.names[motor].empty())
      continue;
    levels[motor] = 1;
    push(source.get(), levels, at, kOn);
    levels[motor] = 0;
    push(source.get(), levels, at + kOn, kOff);
    if (!std::exchange(is_open, true)) { // until the device is open
      gst_element_get_state(pipeline.get(), nullptr, nullptr, GST_CLOCK_TIME_NONE);
      ended(pipeline.get(), at, hold, info);
      if (is_simulated(sink, warnings.empty() ? info : warnings.back()))
        show(_("simulated, as the driver is the simulator"));
      std::ranges::for_each(warnings, warn);
    }
    ended(pipeline.get(), at, warn, info);
    show(motors.names[motor]);
    at += kOn + kOff;
  }
  gst_app_src_end_of_stream(GST_APP_SRC(source.get()));
  while (!ended(pipeline.get(), GST_CLOCK_TIME_NONE, warn, info))
    continue;
}
