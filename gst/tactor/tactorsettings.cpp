// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactorsettings.h"

#include "../rangedproperty.h"
#include "tactor/mapping.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

namespace {

#define GST_TYPE_TACTOR_COMPENSATION (gst_tactor_compensation_get_type())
GType
gst_tactor_compensation_get_type(void)
{
  static const GEnumValue values[] = {
    { static_cast<gint>(tactor::Compensation::exact),
      "Issued exactly one rise time before the frame", "exact" },
    { static_cast<gint>(tactor::Compensation::frame_block),
      "Rise time rounded up to whole frames (Kim et al. 2012)", "frame-block" },
    { static_cast<gint>(tactor::Compensation::none), "Issued with the frame", "none" },
    { 0, nullptr, nullptr },
  };
  static const GType type = g_enum_register_static("GstTactorCompensation", values);
  return type;
}

/// Longer times are taken as that, some thirty years: sums of them do not overflow.
constexpr guint64 kLongest = 1'000'000'000'000'000'000;

tactor::Time
time_from_value(const GValue *value)
{
  return tactor::Time(static_cast<gint64>(MIN(g_value_get_uint64(value), kLongest)));
}

void
time_to_value(tactor::Time time, GValue *value)
{
  g_value_set_uint64(value, static_cast<guint64>(time.count()));
}

std::string
string_from_value(const GValue *value)
{
  const gchar *text = g_value_get_string(value);
  return text ? text : "";
}

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
TactorSettings::set_mapping(const std::string &text)
{
  tl::expected<std::vector<int>, tactor::DriverError> mapping
      = tactor::read_mapping(text, kMaxTactors);
  mapping_error = mapping ? "" : mapping.error().text;
  if (mapping)
    planner.mapping = std::move(*mapping);
}

void
TactorSettings::install(GObjectClass *klass)
{
  const auto ready = static_cast<GParamFlags>(G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS
                                              | GST_PARAM_MUTABLE_READY);
  const auto playing = static_cast<GParamFlags>(G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS
                                                | GST_PARAM_MUTABLE_PLAYING);
  const auto controllable = static_cast<GParamFlags>(playing | GST_PARAM_CONTROLLABLE);
  const TactorSettings unset;
  const tactor::PlannerSettings &defaults = unset.planner;

  g_object_class_install_property(
      klass, TACTOR_PROP_DRIVER,
      g_param_spec_string(
          "driver", "Driver",
          "What drives the tactors: auto (firmata if a board is there, else simulator), "
          "firmata (any board with StandardFirmata), seat (one whose firmware has "
          "the watchdog), simulator (motors predicted, no hardware)",
          unset.driver.c_str(), ready));
  g_object_class_install_property(
      klass, TACTOR_PROP_DEVICE,
      g_param_spec_string("device", "Device",
                          "Which board: its serial number or bus path (unset: the first that "
                          "answers); for the simulator, a CSV file that gets the predicted "
                          "amplitudes (unset: none)",
                          nullptr, ready));
  g_object_class_install_property(
      klass, TACTOR_PROP_RATE,
      ranged::real("rate", "Rate", "How often the tactors may change, in Hz (0 = with every map)",
                   0, 1000, defaults.rate, playing));
  g_object_class_install_property(
      klass, TACTOR_PROP_COMPENSATION,
      g_param_spec_enum(
          "compensation", "Compensation", "How commands are moved ahead by the motors' rise time",
          GST_TYPE_TACTOR_COMPENSATION, static_cast<gint>(defaults.compensation), playing));
  g_object_class_install_property(
      klass, TACTOR_PROP_MAX_LEAD,
      ranged::uint(
          "max-lead", "Max lead",
          "Longest time in ms by which a command is issued before its frame; all other sinks are "
          "delayed by it",
          0, 1000,
          static_cast<guint>(
              std::chrono::duration_cast<std::chrono::milliseconds>(defaults.max_lead).count()),
          ready));
  g_object_class_install_property(klass, TACTOR_PROP_VOLTAGE_MAX,
                                  ranged::real("voltage-max", "Maximum voltage",
                                               "Volts at the motor for level 1.0", 0.1, 24,
                                               defaults.volts_max, ready));
  g_object_class_install_property(
      klass, TACTOR_PROP_VOLTAGE_MIN,
      ranged::real("voltage-min", "Minimum voltage",
                   "Commands below this many volts are sent as 0: the motor would not start", 0, 24,
                   defaults.volts_min, playing));
  g_object_class_install_property(
      klass, TACTOR_PROP_INTENSITY,
      ranged::real("intensity", "Intensity",
                   "Master intensity, a factor on all levels, from the next map on", 0, 1,
                   defaults.intensity, controllable));
  g_object_class_install_property(
      klass, TACTOR_PROP_MUTE,
      g_param_spec_boolean("mute", "Mute",
                           "All motors at zero, at once; the film is followed silently", FALSE,
                           controllable));
  g_object_class_install_property(
      klass, TACTOR_PROP_MAPPING,
      g_param_spec_string("mapping", "Mapping",
                          "Tactor of each cell, row by row from the top left, -1 for none, as in "
                          "2,1,0 (empty: cell i is tactor i)",
                          "", playing));
  g_object_class_install_property(
      klass, TACTOR_PROP_MAX_ON_TIME,
      g_param_spec_uint64("max-on-time", "Maximum on-time",
                          "How long in ns a tactor is on without a break before its cue is over "
                          "(0 = unlimited)",
                          0, G_MAXUINT64, static_cast<guint64>(defaults.limits.max_on_time.count()),
                          playing));
  g_object_class_install_property(
      klass, TACTOR_PROP_MAX_DUTY,
      ranged::real("max-duty", "Maximum duty",
                   "Share of any 60 s for which a tactor is on (0 = unlimited)", 0, 1,
                   defaults.limits.max_duty, playing));
  g_object_class_install_property(
      klass, TACTOR_PROP_MAX_ACTIVE,
      ranged::uint("max-active", "Maximum active",
                   "How many tactors are on at once, the strongest (0 = unlimited)", 0, kMaxTactors,
                   static_cast<guint>(defaults.limits.max_active), playing));
  g_object_class_install_property(
      klass, TACTOR_PROP_RAMP_IN,
      g_param_spec_uint64("ramp-in", "Ramp in",
                          "Time in ns in which the first vibration after start, seek, pause and "
                          "mute may rise to full scale (0 = at once)",
                          0, G_MAXUINT64, static_cast<guint64>(unset.ramp_in.count()), playing));
  g_object_class_install_property(
      klass, TACTOR_PROP_KICK_START,
      g_param_spec_boolean("kick-start", "Kick start",
                           "Start motors from rest with a pulse of full voltage, until they are "
                           "predicted to be at 90 % of their level",
                           defaults.kick_start, playing));
  g_object_class_install_property(
      klass, TACTOR_PROP_CALIBRATION,
      g_param_spec_string(
          "calibration", "Calibration",
          "Key file of tactor-calibrate with what was measured of each motor: rise "
          "times, latency, start and hold volts, vibration for volts (unset: all are "
          "the paper's)",
          nullptr, ready));
  g_object_class_install_property(
      klass, TACTOR_PROP_TRACE_LOCATION,
      g_param_spec_string("trace-location", "Trace location",
                          "CSV file that gets one line a command: "
                          "issued_ns,due_ns,effect_ns,tactor,volts (unset: none)",
                          nullptr, ready));
  g_object_class_install_property(
      klass, TACTOR_PROP_REALTIME,
      g_param_spec_boolean("realtime", "Real-time",
                           "Threads that bring commands to the motors ask to run before others: "
                           "directly, else by RealtimeKit or the desktop portal",
                           unset.realtime, ready));
  g_object_class_install_property(
      klass, TACTOR_PROP_STATS,
      g_param_spec_boxed(
          "actuation-stats", "Actuation statistics",
          "Commands issued, late, coalesced, dropped; cues that limits cut; schedule error "
          "|issued - due| in ns; the board, its pins and the bytes sent to it",
          GST_TYPE_STRUCTURE, static_cast<GParamFlags>(G_PARAM_READABLE | G_PARAM_STATIC_STRINGS)));
  gst_type_mark_as_plugin_api(GST_TYPE_TACTOR_COMPENSATION, static_cast<GstPluginAPIFlags>(0));
}

bool
TactorSettings::set(guint id, const GValue *value)
{
  switch (id) {
  case TACTOR_PROP_DRIVER:
    driver = string_from_value(value);
    break;
  case TACTOR_PROP_DEVICE:
    device = string_from_value(value);
    break;
  case TACTOR_PROP_RATE:
    planner.rate = g_value_get_double(value);
    break;
  case TACTOR_PROP_COMPENSATION:
    planner.compensation = static_cast<tactor::Compensation>(g_value_get_enum(value));
    break;
  case TACTOR_PROP_MAX_LEAD:
    planner.max_lead = std::chrono::milliseconds(g_value_get_uint(value));
    break;
  case TACTOR_PROP_VOLTAGE_MAX:
    planner.volts_max = g_value_get_double(value);
    break;
  case TACTOR_PROP_VOLTAGE_MIN:
    planner.volts_min = g_value_get_double(value);
    break;
  case TACTOR_PROP_INTENSITY:
    planner.intensity = g_value_get_double(value);
    break;
  case TACTOR_PROP_MUTE:
    mute = g_value_get_boolean(value);
    break;
  case TACTOR_PROP_MAPPING:
    set_mapping(string_from_value(value));
    break;
  case TACTOR_PROP_MAX_ON_TIME:
    planner.limits.max_on_time = time_from_value(value);
    break;
  case TACTOR_PROP_MAX_DUTY:
    planner.limits.max_duty = g_value_get_double(value);
    break;
  case TACTOR_PROP_MAX_ACTIVE:
    planner.limits.max_active = static_cast<int>(g_value_get_uint(value));
    break;
  case TACTOR_PROP_RAMP_IN:
    ramp_in = time_from_value(value);
    break;
  case TACTOR_PROP_KICK_START:
    planner.kick_start = g_value_get_boolean(value);
    break;
  case TACTOR_PROP_CALIBRATION:
    calibration = string_from_value(value);
    break;
  case TACTOR_PROP_TRACE_LOCATION:
    trace_location = string_from_value(value);
    break;
  case TACTOR_PROP_REALTIME:
    realtime = g_value_get_boolean(value);
    break;
  default:
    return false;
  }
  return true;
}

bool
TactorSettings::get(guint id, GValue *value) const
{
  switch (id) {
  case TACTOR_PROP_DRIVER:
    g_value_set_string(value, driver.c_str());
    break;
  case TACTOR_PROP_DEVICE:
    g_value_set_string(value, device.empty() ? nullptr : device.c_str());
    break;
  case TACTOR_PROP_RATE:
    g_value_set_double(value, planner.rate);
    break;
  case TACTOR_PROP_COMPENSATION:
    g_value_set_enum(value, static_cast<gint>(planner.compensation));
    break;
  case TACTOR_PROP_MAX_LEAD:
    g_value_set_uint(
        value,
        static_cast<guint>(
            std::chrono::duration_cast<std::chrono::milliseconds>(planner.max_lead).count()));
    break;
  case TACTOR_PROP_VOLTAGE_MAX:
    g_value_set_double(value, planner.volts_max);
    break;
  case TACTOR_PROP_VOLTAGE_MIN:
    g_value_set_double(value, planner.volts_min);
    break;
  case TACTOR_PROP_INTENSITY:
    g_value_set_double(value, planner.intensity);
    break;
  case TACTOR_PROP_MUTE:
    g_value_set_boolean(value, mute);
    break;
  case TACTOR_PROP_MAPPING:
    g_value_take_string(value, g_strdup(tactor::write_mapping(planner.mapping).c_str()));
    break;
  case TACTOR_PROP_MAX_ON_TIME:
    time_to_value(planner.limits.max_on_time, value);
    break;
  case TACTOR_PROP_MAX_DUTY:
    g_value_set_double(value, planner.limits.max_duty);
    break;
  case TACTOR_PROP_MAX_ACTIVE:
    g_value_set_uint(value, static_cast<guint>(planner.limits.max_active));
    break;
  case TACTOR_PROP_RAMP_IN:
    time_to_value(ramp_in, value);
    break;
  case TACTOR_PROP_KICK_START:
    g_value_set_boolean(value, planner.kick_start);
    break;
  case TACTOR_PROP_CALIBRATION:
    g_value_set_string(value, calibration.empty() ? nullptr : calibration.c_str());
    break;
  case TACTOR_PROP_TRACE_LOCATION:
    g_value_set_string(value, trace_location.empty() ? nullptr : trace_location.c_str());
    break;
  case TACTOR_PROP_REALTIME:
    g_value_set_boolean(value, realtime);
    break;
  default:
    return false;
  }
  return true;
}
