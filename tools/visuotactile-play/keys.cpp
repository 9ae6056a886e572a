// SPDX-License-Identifier: LGPL-2.1-or-later
#include "keys.h"
#include "translation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

namespace {

constexpr double kStep = std::numbers::sqrt2;
constexpr double kLeastDensity = 0.05;
constexpr double kIntensityStep = 0.1;

double
property(GstElement *element, const char *name)
{
  gdouble value = 0;
  g_object_get(element, name, &value, nullptr);
  return value;
}

template <typename... Values>
std::string
text(const char *format, Values... values)
{
  char line[160]; // longer than any
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

std::string
turn_intensity(GstElement *chair, bool up)
{
  const double now = property(chair, "intensity") + (up ? kIntensityStep : -kIntensityStep);
  const double intensity = std::clamp(std::round(now / kIntensityStep) * kIntensityStep, 0.0, 1.0);
  g_object_set(chair, "intensity", intensity, nullptr);
  return text(_("Intensity %.0f %%"), 100 * intensity);
}

std::string
steer(GstElement *analysis, std::string_view key)
{
  double sensitivity = property(analysis, "sensitivity");
  double density = property(analysis, "density");
  if (key == "1" || key == "2") {
    sensitivity = std::clamp(sensitivity * (key == "2" ? kStep : 1 / kStep), 0.1, 10.0);
    g_object_set(analysis, "sensitivity", sensitivity, nullptr);
  } else {
    const double any = density > 0 ? density : 1; // 1 is any, too
    density = std::max(kLeastDensity, any * (key == "4" ? kStep : 1 / kStep));
    density = density < 0.99 ? density : 0;
    g_object_set(analysis, "density", density, nullptr);
  }
  return text(_("Sensitivity %.2f, density %.0f %%%s"), sensitivity,
              100 * (density > 0 ? density : 1), density > 0 ? "" : _(" (off)"));
}

} // namespace

std::optional<int>
seek_of(std::string_view key)
{
  constexpr std::array<std::pair<std::string_view, int>, 4> kSeeks
      = { { { "Left", -10 }, { "Right", 10 }, { "Down", -60 }, { "Up", 60 } } };
  for (const auto &[name, seconds] : kSeeks)
    if (name == key)
      return seconds;
  return std::nullopt;
}

bool
is_steering(std::string_view key)
{
  return key == "1" || key == "2" || key == "3" || key == "4";
}

std::string
turn(std::string_view key, GstElement *analysis, GstElement *chair)
{
  if (key == "plus" || key == "equal" || key == "KP_Add")
    return turn_intensity(chair, true);
  if (key == "minus" || key == "KP_Subtract")
    return turn_intensity(chair, false);
  if (key == "m") {
    gboolean mute = FALSE;
    g_object_get(chair, "mute", &mute, nullptr);
    g_object_set(chair, "mute", !mute, nullptr);
    return mute ? _("Vibration on") : _("Vibration off");
  }
  return is_steering(key) ? steer(analysis, key) : "";
}

std::string
clock_time(GstClockTime time)
{
  const auto seconds = static_cast<unsigned long long>(time / GST_SECOND);
  return seconds < 3600
             ? text("%llu:%02llu", seconds / 60, seconds % 60)
             : text("%llu:%02llu:%02llu", seconds / 3600, seconds / 60 % 60, seconds % 60);
}
