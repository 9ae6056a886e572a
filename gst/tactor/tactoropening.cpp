// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactoropening.h"

#include "calibration/calibration.h"
#include "tactor/drivers/last_device.h"
#include "tactor/drivers/registry.h"
#include "tactor/soft_start.h"
#include "tactormessages.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

using tactor::Time;

GST_DEBUG_CATEGORY_EXTERN(tactor_sink_debug);
#define GST_CAT_DEFAULT tactor_sink_debug

namespace {

/// The lead of a live stream: twice the time of the first answers rather than the longest possible
/// time, because its picture always waits for it. At least 40 ms, because later answers may take
/// longer.
Time
live_latency(const tactor::Driver &driver)
{
  constexpr Time kLeast = std::chrono::milliseconds(40);
  return std::min(std::max(2 * driver.transport_latency(), kLeast), driver.longest_latency());
}

/// The motors of the calibration. Raises `latency` to their longest one.
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
                        ("the calibration needs leads of up to %" G_GINT64_FORMAT
                         " ms, max-lead is %" G_GINT64_FORMAT " ms",
                         static_cast<gint64>(longest.count() / GST_MSECOND),
                         static_cast<gint64>(settings.planner.max_lead.count() / GST_MSECOND)));
  return motors;
}

/// The tactors of a board that the mapping uses.
std::vector<std::size_t>
used_tactors(const std::vector<int> &mapping, int tactors)
{
  std::vector<std::size_t> used(static_cast<std::size_t>(tactors));
  std::iota(used.begin(), used.end(), std::size_t{ 0 });
  const std::set<int> named(mapping.begin(), mapping.end());
  if (!mapping.empty())
    std::erase_if(used, [&](std::size_t i) { return !named.contains(static_cast<int>(i)); });
  return used;
}

/// Posts a message if an update of the chair takes the line longer than a step of a soft start or a
/// block.
void
check_line(GstElement *element, const tactor::PlannerSettings &settings,
           const tactor::Driver &driver)
{
  const std::vector<std::size_t> used = used_tactors(settings.mapping, driver.tactors());
  Time step = tactor::SoftStart::kStep;
  if (settings.rate > 0)
    step = std::min(step, Time(static_cast<gint64>(GST_SECOND / settings.rate)));
  const tactor::LineTime &line = settings.line;
  if (line.of(used) <= step)
    return;
  TactorLineLoad load{ .tactors = used.size(),
                       .bytes = line.bytes(used),
                       .update = line.of(used),
                       .at_once = line.of(used, settings.limits.most_changes()) };
  // As many may end as begin.
  while (line.of(used, 2 * (load.most_active + 1)) <= step)
    load.most_active++;
  tactor_post_line_load(element, load, load.at_once > step);
}

} // namespace

tl::expected<TactorOpening, tactor::DriverError>
prepare_tactors(GstElement *element, const TactorSettings &settings)
{
  if (!settings.device.empty() && settings.device == settings.trace_location)
    return tl::unexpected(tactor::DriverError{ tactor::DriverError::Kind::settings,
                                               "device and trace-location are the same file, '"
                                                   + settings.device + "'; expected two" });
  TactorOpening opening{ .settings = settings };
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
  opening.turn = std::make_unique<tactor::OpeningTurn>();
  return opening;
}

tl::expected<std::pair<OpenTactors, TactorOutput>, tactor::DriverError>
open_tactors(GstElement *element, TactorOpening opening,
             std::function<void(const tactor::DriverEvent &)> notify, std::stop_token stop)
{
  const TactorSettings &settings = opening.settings;
  const tactor::DriverConfig config{ .device = settings.device,
                                     .max_tactors = TactorSettings::kMaxTactors,
                                     .min_tactors = settings.needed_tactors(),
                                     .full_scale_volts = settings.planner.volts_max,
                                     .realtime = settings.realtime,
                                     .guardian = settings.guardian,
                                     .limits = settings.planner.limits,
                                     .stop = std::move(stop),
                                     .notify = std::move(notify) };
  TactorOutput output{ .driver = std::move(opening.driver) };
  const std::unique_ptr<tactor::OpeningTurn> turn = std::move(opening.turn); // ends here
  turn->wait(config.stop);
  if (const tl::expected<void, tactor::DriverError> opened = output.driver->open(config); !opened)
    return tl::unexpected(opened.error());
  if (!settings.trace_location.empty() && !config.stop.stop_requested()) {
    tl::expected<tactor::CommandTrace, tactor::DriverError> trace
        = tactor::CommandTrace::create(settings.trace_location);
    if (!trace)
      return tl::unexpected(trace.error());
    output.trace = std::make_unique<tactor::CommandTrace>(std::move(*trace));
  }

  if (const std::string board = output.driver->status().board; board != "simulator")
    tactor::remember_device({ .driver = settings.driver == "auto" ? "firmata" : settings.driver,
                              .device = settings.device,
                              .board = board });
  const tactor::Driver &driver = *output.driver;
  tactor::PlannerSettings planner = settings.planner;
  planner.transport_latency = driver.transport_latency();
  planner.line = driver.line();
  check_line(element, planner, driver);
  // A motor's latency was measured while the others did not change.
  const Time of_motors = opening.latency + planner.line.all();
  OpenTactors tactors{ .planner = std::move(planner),
                       .motors = std::move(opening.motors),
                       .count = driver.tactors(),
                       .layout = driver.layout(),
                       .account = driver.account(),
                       .latency = std::max(of_motors, driver.longest_latency()),
                       .live_latency = std::max(of_motors, live_latency(driver)) };
  return std::pair(std::move(tactors), std::move(output));
}
