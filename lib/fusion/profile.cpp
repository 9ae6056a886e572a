// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/profile.h"

#include <algorithm>
#include <iterator>

namespace fusion {

namespace {

using tactile::Mix;

constexpr Profile kProfiles[] = {
  { "film", "The picture, made stronger by impacts, and impacts that are not seen; no rumble",
    Mix::accent, 0, true, false },
  { "music", "The picture, and beside it impacts and rumble where they sound", Mix::max, 0, true,
    true },
  { "dialogue-heavy",
    "The picture, made stronger by impacts, at 6 dB less; no sound without a picture", Mix::stress,
    -6, true, false },
  { "bass-shaker", "Impacts and rumble where they sound, at 6 dB more; no picture", Mix::replace, 6,
    true, true },
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
