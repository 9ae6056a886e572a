// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactoropening.h"

#include "tactor/calibration/calibration.h"

#include <algorithm>
#include <utility>

using tactor::Time;

GST_DEBUG_CATEGORY_EXTERN(tactor_sink_debug);
#define GST_CAT_DEFAULT tactor_sink_debug

namespace {

/// The motors that were measured, and the longest latency among them.
tl::expected<std::vector<tactor::MotorParameters>, tactor::DriverError>
read_motors(GstElement *element, const TactorSettings &settings, Time &latency)
{
  if (settings.calibration.empty())
    return std::vector<tactor::MotorParameters>();
  const tl::expected<tactor::Calibration, std::string> calibration
      = tactor::read_calibration(settings.calibration);
  if (!calibration)
    return tl::unexpected(
        tactor::DriverError{ tactor::DriverError::Kind::settings, calibration.error() });
  std::vector<tactor::MotorParameters> motors = calibration->motors(settings.planner.volts_max);
  for (const tactor::MotorParameters &motor : motors)
    latency = std::max(latency, motor.latency.value_or(Time(0)));
  const Time longest = calibration->longest_lead();
  if (longest > settings.planner.max_lead + latency)
    GST_ELEMENT_WARNING(element, RESOURCE, SETTINGS,
                        ("Some vibrations will come late: the motors are slower than max-lead."),
                        ("the calibration asks for leads of up to %" G_GINT64_FORMAT
                         " ms, max-lead is %" G_GINT64_FORMAT " ms",
                         static_cast<gint64>(longest.count() / GST_MSECOND),
                         static_cast<gint64>(settings.planner.max_lead.count() / GST_MSECOND)));
  return motors;
}

} // namespace

tl::expected<TactorOpening, tactor::DriverError>
open_tactors(GstElement *element, const TactorSettings &settings,
             std::function<void(const tactor::DriverEvent &)> notify)
{
  if (!settings.device.empty() && settings.device == settings.trace_location)
    return tl::unexpected(tactor::DriverError{ tactor::DriverError::Kind::settings,
                                               "device and trace-location are the same file, '"
                                                   + settings.device + "'; expected two" });
  const tactor::DriverConfig config{ .device = settings.device,
                                     .max_tactors = TactorSettings::kMaxTactors,
                                     .min_tactors = settings.needed_tactors(),
                                     .full_scale_volts = settings.planner.volts_max,
                                     .realtime = settings.realtime,
                                     .notify = std::move(notify) };
  TactorOpening opening;
  tl::expected<std::vector<tactor::MotorParameters>, tactor::DriverError> motors
      = read_motors(element, settings, opening.latency);
  if (!motors)
    return tl::unexpected(motors.error());
  opening.motors = std::move(*motors);
  tl::expected<std::unique_ptr<tactor::Driver>, tactor::DriverError> driver
      = tactor::make_driver(settings.driver);
  if (!driver)
    return tl::unexpected(driver.error());
  opening.driver = std::move(*driver);
  if (const tl::expected<void, tactor::DriverError> opened = opening.driver->open(config); !opened)
    return tl::unexpected(opened.error());
  if (!settings.trace_location.empty()) {
    tl::expected<tactor::CommandTrace, tactor::DriverError> trace
        = tactor::CommandTrace::create(settings.trace_location);
    if (!trace)
      return tl::unexpected(trace.error());
    opening.trace = std::make_unique<tactor::CommandTrace>(std::move(*trace));
  }

  opening.planner = settings.planner;
  opening.planner.transport_latency = opening.driver->transport_latency();
  opening.latency = std::max(opening.latency, opening.planner.transport_latency);
  return opening;
}
