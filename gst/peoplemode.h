// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sharedenum.h"

/// How saliencytactile looks for people; also a property of bins that hold one.
enum class PeopleMode
{
  off,
  fast,
  thorough,
  automatic,
};

inline GType
people_mode_type()
{
  static const GEnumValue values[] = {
    { static_cast<gint>(PeopleMode::off), "No faces", "off" },
    { static_cast<gint>(PeopleMode::fast), "Faces from about a sixteenth of the picture on",
      "fast" },
    { static_cast<gint>(PeopleMode::thorough), "Smaller faces too, for twice the work",
      "thorough" },
    { static_cast<gint>(PeopleMode::automatic), "As fast, where the face detector is installed",
      "auto" },
    { 0, nullptr, nullptr },
  };
  return shared_enum_type("GstSaliencyTactilePeople", values);
}
