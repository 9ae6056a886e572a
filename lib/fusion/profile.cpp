// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/profile.h"

#include <algorithm>
#include <iterator>

namespace fusion {

namespace {

using tactile::Mix;

constexpr Profile kProfiles[] = {
  { "film",
    "Events of the picture, which impacts in the sound strengthen, and impacts without an event; "
    "no rumble",
    Mix::accent, 0, true, false },
  { "music", "Events of the picture, and impacts and rumble at the place of their sound", Mix::max,
    0, true, true },
  { "dialogue-heavy",
    "Events of the picture, which impacts at 6 dB less strengthen; no impacts without an event",
    Mix::stress, -6, true, false },
  { "bass-shaker",
    "Impacts and rumble at the place of their sound, at 6 dB more; no events of the picture",
    Mix::replace, 6, true, true },
};

} // namespace

std::span<const Profile>
profiles()
{
  return kProfiles;
}

const Profile *
find_profile(std::string_view name)
{
  const auto found = std::ranges::find(kProfiles, name, &Profile::name);
  return found == std::end(kProfiles) ? nullptr : found;
}

} // namespace fusion
