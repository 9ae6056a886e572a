// SPDX-License-Identifier: LGPL-2.1-or-later
#include "steering.h"

#include <algorithm>
#include <cstdio>
#include <numbers>

bool
steer(GstElement *analysis, std::string_view key)
{
  constexpr double kStep = std::numbers::sqrt2;
  constexpr double kLeastDensity = 0.05;
  gdouble sensitivity = 1;
  gdouble density = 0;
  g_object_get(analysis, "sensitivity", &sensitivity, "density", &density, nullptr);
  if (key == "Up" || key == "Down") {
    sensitivity = std::clamp(sensitivity * (key == "Up" ? kStep : 1 / kStep), 0.1, 10.0);
    g_object_set(analysis, "sensitivity", sensitivity, nullptr);
    return true;
  }
  if (key == "Left" || key == "Right") {
    const double any = density > 0 ? density : 1; // 1 is any, too
    density = std::max(kLeastDensity, any * (key == "Right" ? kStep : 1 / kStep));
    g_object_set(analysis, "density", density < 0.99 ? density : 0.0, nullptr);
    return true;
  }
  return false;
}

std::string
steering_text(GstElement *analysis)
{
  gdouble sensitivity = 1;
  gdouble density = 0;
  g_object_get(analysis, "sensitivity", &sensitivity, "density", &density, nullptr);
  char text[80];
  std::snprintf(text, sizeof text, "Sensitivity %.2f, density %.0f %%%s", sensitivity,
                100 * (density > 0 ? density : 1), density > 0 ? "" : " (off)");
  return text;
}
