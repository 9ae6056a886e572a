// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/mix.h"

#include <span>
#include <string_view>

namespace fusion {

/// The part of a film's sound that joins the picture, and its gain.
struct Profile
{
  const char *name;
  const char *does; ///< one sentence for a list
  tactile::Mix mix;
  double gain_db; ///< added to every sound before its level
  bool impacts;   ///< impacts, explosions and shots are felt
  bool rumble;    ///< sustained sound below 65 Hz is felt
};

/// All profiles, `film` first. Without sound, there is no profile.
std::span<const Profile> profiles();

/// The profile of this name; nullptr if there is none, as for "off".
const Profile *find_profile(std::string_view name);

} // namespace fusion
