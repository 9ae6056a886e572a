// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/place.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sound {

namespace {

/// Below this likeness left and right are different sounds: nowhere in between, but all around.
constexpr double kAlike = 0.6;
constexpr double kUnlike = 0.2;

/// How much of a sound at `at` in [0, 1] is felt in cell `index` of `count`. The cells around it
/// share it; on large grids, a third of the side.
double
share(double at, int index, int count, double reach)
{
  return std::max(0.0, 1 - std::abs(at * (count - 1) - index) / std::max(1.0, count / reach));
}

} // namespace

bool
has_rear(std::span<const Speaker> speakers)
{
  return std::ranges::any_of(speakers, [](const Speaker &speaker) {
    return speaker.role == Speaker::Role::place && speaker.behind > 0;
  });
}

Place
place_of(std::span<const Speaker> speakers, std::span<const double> powers, double likeness)
{
  double left = 0;
  double right = 0;
  double front = 0;
  double rear = 0;
  double elsewhere = 0;
  for (std::size_t c = 0; c < speakers.size(); c++) {
    const Speaker &speaker = speakers[c];
    if (speaker.role != Speaker::Role::place) {
      elsewhere += powers[c];
      continue;
    }
    const double to_right = (speaker.across + 1) / 2;
    left += (1 - to_right) * powers[c];
    right += to_right * powers[c];
    front += (1 - speaker.behind) * powers[c];
    rear += speaker.behind * powers[c];
  }
  Place place;
  const double placed = left + right;
  if (!(placed > 0))
    return place;
  constexpr double kQuarter = std::numbers::pi / 2;
  // The inverse of panning by constant power.
  place.across = 2 * std::atan2(std::sqrt(right), std::sqrt(left)) / kQuarter - 1;
  place.behind = std::atan2(std::sqrt(rear), std::sqrt(front)) / kQuarter;
  const double unlike = std::clamp((kAlike - likeness) / (kAlike - kUnlike), 0.0, 1.0)
                        * (1 - std::abs(place.across)) * front / placed;
  place.everywhere = std::max(unlike, elsewhere / (placed + elsewhere));
  return place;
}

void
raise(tactile::TactileMap &map, const Place &place, bool has_rear, float level)
{
  constexpr double kColumnReach = 3;
  constexpr double kRowReach = 2;
  for (int row = 0; row < map.rows; row++)
    for (int column = 0; column < map.columns; column++) {
      const double across = share((place.across + 1) / 2, column, map.columns, kColumnReach);
      const double along = has_rear ? share(place.behind, row, map.rows, kRowReach) : 1;
      const double here = place.everywhere + (1 - place.everywhere) * across * along;
      float &cell = map.at(row, column);
      cell = std::max(cell, level * static_cast<float>(here));
    }
}

} // namespace sound
