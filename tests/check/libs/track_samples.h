// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tracks/track.h"

#include <random>
#include <string>

#include <gst/check/gstcheck.h>

inline tactile::TactileMap
make_map(int rows, int columns, std::initializer_list<float> levels)
{
  tactile::TactileMap map(rows, columns);
  map.levels = levels;
  return map;
}

/// Two tactors of a 3 × 3 grid at 75 % from 1.0 s to 1.4 s: the content of the reference files.
inline tactile::Track
two_tactors(tactile::Time end = std::chrono::milliseconds(1400))
{
  using namespace std::chrono_literals;
  tactile::Track track(3, 3);
  track.append(1000ms, make_map(3, 3, { 0, 0, 0, 0, 0.75F, 0.75F, 0, 0, 0 }));
  track.append(1400ms, tactile::TactileMap(3, 3));
  track.set_end(end);
  return track;
}

/// A track of random grid, times (multiples of `tick`) and levels (multiples of 1 / steps, any if
/// 0). A third of the maps are silent. Beginning at 0 and ending in silence are random, too.
inline tactile::Track
random_track(unsigned seed, tactile::Time tick, int steps)
{
  std::mt19937 random(seed);
  const auto below = [&](int n) {
    return static_cast<int>(random() % static_cast<unsigned>(n));
  };
  tactile::Track track(1 + below(8), 1 + below(8));
  track.set_rate(below(2) ? 5 : 12.5);
  tactile::Time time{ 0 };
  for (int i = below(2); i < 40; i++) {
    tactile::TactileMap map(track.rows(), track.columns());
    if (below(3) > 0)
      for (float &level : map.levels)
        level = below(2) == 0 ? 0.0F
                : steps > 0   ? static_cast<float>(below(steps + 1)) / static_cast<float>(steps)
                              : static_cast<float>(below(1 << 24)) / static_cast<float>(1 << 24);
    if (i > 0)
      time += tick * (1 + below(3000));
    track.append(time, map);
  }
  track.set_end(time + tick * (1 + below(5000)));
  return track;
}

/// The path of a file in tests/check/data.
inline std::string
data_file(const std::string &name)
{
  const gchar *folder = g_getenv("TEST_DATA");
  return (folder != nullptr ? std::string(folder) : "tests/check/data") + "/" + name;
}

/// The error of reading, which must fail.
template <typename Read>
std::string
complaint(const tl::expected<Read, tactile::FormatError> &read)
{
  fail_if(read.has_value(), "expected an error, got a track");
  return read.error().text();
}

/// Like fail_unless_equals_string(), which would read a temporary after its end.
#define ASSERT_TEXT(actual, expected)                                                              \
  do {                                                                                             \
    const std::string actual_text = actual;                                                        \
    fail_unless_equals_string(actual_text.c_str(), expected);                                      \
  } while (0)

/// Checks that reading fails, at `place` and for this reason.
#define ASSERT_COMPLAINT(read, place, reason)                                                      \
  do {                                                                                             \
    const std::string said = complaint(read);                                                      \
    fail_unless(said.starts_with(place) && said.find(reason) != std::string::npos,                 \
                "error '%s', expected '%s... %s'", said.c_str(), place, reason);                   \
  } while (0)
