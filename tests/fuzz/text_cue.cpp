// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Fuzzes text cues of subtitle streams, with and without a grid: a cue that parses is a valid map
// and survives a round trip.
#include "tracks/text_cue.h"
#include "fuzz.h"
#include "tracks/track.h"

#include <string_view>

using namespace tactile;

namespace {

void
check(std::string_view text, std::optional<Grid> grid)
{
  const auto map = read_text_cue(text, grid);
  if (!map)
    return expect(!map.error().text().empty());
  expect(map->rows >= 1 && map->columns >= 1
         && map->levels.size()
                == static_cast<std::size_t>(map->rows) * static_cast<std::size_t>(map->columns));
  expect(!grid || (map->rows == grid->rows && map->columns == grid->columns));
  for (const float level : map->levels)
    expect(level >= 0 && level <= 1);
  const std::string once = write_text_cue(*map);
  expect(write_text_cue(*read_text_cue(once, Grid{ map->rows, map->columns })) == once);
}

} // namespace

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  const std::string_view text(reinterpret_cast<const char *>(data), size);
  check(text, {});
  check(text, Grid{ 2, 2 });
  read_grid(text, 1);
  return 0;
}
