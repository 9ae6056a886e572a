// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sharedenum.h"

/// The effect of a camera that travels; also a property of bins that hold a saliencytactile.
enum class CameraMode
{
  off,
  gentle,
};

inline GType
camera_mode_type()
{
  static const GEnumValue values[] = {
    { static_cast<gint>(CameraMode::off), "Nothing", "off" },
    { static_cast<gint>(CameraMode::gentle),
      "A soft wave in the direction of travel, while no event is felt", "gentle" },
    { 0, nullptr, nullptr },
  };
  return shared_enum_type("GstSaliencyTactileCamera", values);
}
