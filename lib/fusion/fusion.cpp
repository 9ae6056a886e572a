// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/fusion.h"

#include <algorithm>

namespace fusion {

using tactile::Mix;
using tactile::TactileMap;

namespace {

constexpr float kOnset = 0.2F;
constexpr Time kLongest = std::chrono::milliseconds(50);

float
strength(const TactileMap &map)
{
  return map.levels.empty() ? 0 : std::ranges::max(map.levels);
}

/// Adds the sound of [begin, end) to the last piece, or begins one.
void
add_piece(std::vector<SoundMap> &pieces, Time begin, Time end, const TactileMap &map)
{
  if (begin >= end)
    return;
  const bool begins = pieces.empty() || pieces.back().end - pieces.back().begin >= kLongest
                      || strength(map) >= strength(pieces.back().map) + kOnset;
  if (begins) {
    pieces.push_back({ begin, end, map });
    return;
  }
  SoundMap &last = pieces.back();
  last.end = end;
  if (last.map.levels.empty())
    last.map = map;
  else if (!map.levels.empty())
    tactile::mix_into(last.map, map, Mix::max);
}

} // namespace

TactileMap
Fusion::mix(Time begin, Time end, const TactileMap &picture, const TactileMap &sound, Mix mix,
            const TactileMap *next)
{
  if (mix == Mix::replace)
    return tactile::resample(sound, picture.rows, picture.columns);
  TactileMap felt = picture;
  const bool seen = !tactile::is_silent(picture);
  const bool placed = mix == Mix::gate || mix == Mix::accent || mix == Mix::stress;
  const bool holds = any_ && begin >= seen_until_ && begin <= seen_until_ + kPlaceHolds;
  const TactileMap *place = holds ? &seen_ : next;
  if (placed && !seen && place && place->rows == picture.rows
      && place->columns == picture.columns) {
    felt = *place;
    mix = Mix::gate;
  }
  tactile::mix_into(felt, sound, mix);
  if (seen) {
    seen_ = picture;
    seen_until_ = end;
    any_ = true;
  }
  return felt;
}

void
Fusion::reset()
{
  any_ = false;
}

std::vector<SoundMap>
pieces(Time begin, Time end, std::span<const SoundMap> sound)
{
  std::vector<SoundMap> pieces;
  Time until = begin;
  for (const SoundMap &heard : sound) {
    const Time from = std::clamp(heard.begin, begin, end);
    add_piece(pieces, until, from, {});
    add_piece(pieces, from, std::min(heard.end, end), heard.map);
    until = std::clamp(heard.end, begin, end);
  }
  add_piece(pieces, until, end, {});
  if (pieces.empty()) // a frame without a length
    pieces.push_back({ begin, end, sound.empty() ? TactileMap() : sound.front().map });
  return pieces;
}

} // namespace fusion
