// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/mix.h"

#include <span>
#include <string_view>

namespace fusion {

/// Which part of a film's sound joins the picture, and how.
struct Profile
{
  const char *name;
  const char *does; ///< one sentence for a list
  tactile::Mix mix;
  double gain_db; ///< added to every sound before its level
  bool impacts;   ///< impacts, explosions and shots are felt
  bool rumble;    ///< what goes on below 65 Hz is felt
};

/// By index: `film` is the first one. No sound at all is none of them.
std::span<const Profile> profiles();

/// That of this name; nullptr if there is none, as for "off".
const Profile *find_profile(std::string_view name);

} // namespace fusion
