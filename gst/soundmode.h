// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "properties.h"

#include "fusion/profile.h"

#include <vector>

/// The felt part of a film's sound: 0 for none, else 1 + a profile's index.
enum class SoundMode
{
  off,
  film,
};

inline GType
sound_mode_type(void)
{
  static const GType type = [] {
    constexpr const char *kName = "GstTactileSound";
    if (const GType known = g_type_from_name(kName)) // of another plugin, which stays loaded
      return known;
    static std::vector<GEnumValue> values{ { 0, "No impacts and no rumble", "off" } };
    for (const fusion::Profile &profile : fusion::profiles())
      values.push_back({ static_cast<gint>(values.size()), profile.does, profile.name });
    values.push_back({ 0, nullptr, nullptr });
    return properties::register_enum(kName, values.data());
  }();
  return type;
}

/// nullptr for nothing.
inline const fusion::Profile *
profile_of(SoundMode mode)
{
  const auto index = static_cast<std::size_t>(mode);
  return index == 0 || index > fusion::profiles().size() ? nullptr : &fusion::profiles()[index - 1];
}
