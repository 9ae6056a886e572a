// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactorsettings.h"

#include "chair/settings.h"
#include "tactor/mapping.h"

#include <algorithm>
#include <utility>

namespace {

GType
compensation_type()
{
  static const GEnumValue values[] = {
    { static_cast<gint>(tactor::Compensation::exact),
      "Commands are issued exactly one rise time before the frame", "exact" },
    { static_cast<gint>(tactor::Compensation::frame_block),
      "Rise time rounded up to whole frames (Kim et al. 2012)", "frame-block" },
    { static_cast<gint>(tactor::Compensation::none), "Commands are issued with the frame", "none" },
    { 0, nullptr, nullptr },
  };
  static const GType type = properties::register_enum("GstTactorCompensation", values);
  return type;
}

std::optional<std::string>
write_mapping(const TactorSettings &settings)
{
  return tactor::write_mapping(settings.planner.mapping);
}

/// Text that cannot be read leaves the mapping unchanged.
void
read_mapping(TactorSettings &settings, const gchar *text)
{
  tl::expected<std::vector<int>, tactor::DriverError> mapping
      = tactor::read_mapping(text ? text : "", TactorSettings::kMaxTactors);
  settings.mapping_error = mapping ? "" : mapping.error().text;
  if (mapping)
    settings.planner.mapping = std::move(*mapping);
}

using P = properties::Property<TactorSettings>;
using properties::kControllable;
using properties::kPlaying;
using properties::kReady;

constexpr P kProperties[] = {
  P::text(
      "driver",
      "Driver: auto (firmata if a board is connected, else simulator), firmata (a board with "
      "StandardFirmata), seat (a board with the watchdog firmware), gamepad (rumble motors), "
      "bhaptics (a vest), intiface (the device in the property device), simulator (no hardware)",
      kReady, PROPERTY_FIELD(driver)),
  P::text("device",
          "Board: serial number or bus path (unset: the first board that answers); gamepad: path "
          "or name; bhaptics: vest-back, vest or another part of a suit; intiface: name; these two "
          "also with @HOST; simulator: CSV file for the predicted amplitudes",
          kReady, PROPERTY_FIELD(device)),
  P::number<gdouble>("rate", "Rate in Hz at which tactors may change (0 = with every map)",
                     kPlaying, PROPERTY_FIELD(planner.rate), P::Range{ 0, 1000 }),
  P::choice("compensation", "Compensation of the motors' rise time", kPlaying,
            PROPERTY_FIELD(planner.compensation), compensation_type),
  P::number<guint64>("max-lead",
                     "Longest time in ns by which a command is issued before its frame; all other "
                     "sinks are delayed by this time",
                     kReady, PROPERTY_FIELD(planner.max_lead), P::Range{ 0, GST_SECOND }),
  P::number<gdouble>("voltage-max", "Volts at the motor for level 1.0", kReady,
                     PROPERTY_FIELD(planner.volts_max), P::Range{ 0.1, 24 }),
  P::number<gdouble>("voltage-min", "Volts below which a motor does not start, so that 0 is sent",
                     kPlaying, PROPERTY_FIELD(planner.volts_min), P::Range{ 0, 24 }),
  P::number<gdouble>("intensity",
                     "Factor on all levels, from the next map on; 0: all motors at zero, at once",
                     kControllable, PROPERTY_FIELD(planner.intensity), P::Range{ 0, 1 }),
  P::flag("mute", "All motors at zero, at once", kControllable, PROPERTY_FIELD(mute)),
  P::number<gdouble>("delay",
                     "Delay of all vibration in ms. A negative one of the start delays all other "
                     "sinks instead",
                     kPlaying, PROPERTY_FIELD(delay),
                     P::Range{ -chair::kMostDelay, chair::kMostDelay }),
  P::parsed<write_mapping, read_mapping>(
      "mapping",
      "Tactor of each cell, row by row, -1 for none, as in 2,1,0 (empty: cell i is tactor i)",
      kPlaying),
  P::number<guint64>("max-on-time",
                     "Longest time in ns for which a tactor is on without a break (0 = unlimited)",
                     kPlaying, PROPERTY_FIELD(planner.limits.max_on_time)),
  P::number<gdouble>("max-duty",
                     "Largest share of any 60 s for which a tactor is on (0 = unlimited)", kPlaying,
                     PROPERTY_FIELD(planner.limits.max_duty), P::Range{ 0, 1 }),
  P::number<guint>("max-active",
                   "Largest number of tactors on at once; the strongest play (0 = unlimited)",
                   kPlaying, PROPERTY_FIELD(planner.limits.max_active),
                   P::Range{ 0, TactorSettings::kMaxTactors }),
  P::number<guint64>(
      "ramp-in",
      "Time in ns in which vibration rises to full scale after start, seek, pause and mute",
      kPlaying, PROPERTY_FIELD(ramp_in)),
  P::flag("kick-start",
          "Start motors from rest with full voltage until they are predicted to be at 90 % of "
          "their level",
          kPlaying, PROPERTY_FIELD(planner.kick_start)),
  P::text("calibration",
          "Key file of tactor-calibrate: each motor's rise times, latency, start volts and "
          "strength (unset: the paper's)",
          kReady, PROPERTY_FIELD(calibration)),
  P::text("trace-location",
          "CSV file to write, one line per command: issued_ns,due_ns,effect_ns,tactor,volts",
          kReady, PROPERTY_FIELD(trace_location)),
  P::flag("realtime",
          "Run the threads that bring commands to the motors at real-time priority, if allowed",
          kReady, PROPERTY_FIELD(realtime)),
  P::flag("guardian",
          "Run a process that stops the motors if this one is killed or crashes, unless the board "
          "has a watchdog",
          kReady, PROPERTY_FIELD(guardian)),
  P::stats("actuation-stats",
           "Numbers of commands, schedule errors in ns, cues that the limits cut, and the board"),
};

} // namespace

void
tactor_ints_to_value(const std::vector<int> &numbers, GValue *value)
{
  for (const int number : numbers) {
    GValue item = G_VALUE_INIT;
    g_value_init(&item, G_TYPE_INT);
    g_value_set_int(&item, number);
    gst_value_array_append_and_take_value(value, &item);
  }
}

int
TactorSettings::needed_tactors() const
{
  const auto last = std::ranges::max_element(planner.mapping);
  return last == planner.mapping.end() ? 1 : std::max(*last + 1, 1);
}

void
TactorSettings::install(GObjectClass *klass, const properties::Element<TactorSettings> &element)
{
  properties::install<TactorSettings>(klass, kProperties, element);
}
