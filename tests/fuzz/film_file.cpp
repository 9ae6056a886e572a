// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Films made up by a fuzzer, whose tactile tracks are left to choice: where none is marked, no byte
// changes; what is marked is found marked, for a second time changes nothing. Anything else ends
// the process.
#include "tracks/formats/film_file.h"
#include "fuzz.h"

#include <vector>

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  const std::vector<std::uint8_t> film(data, data + size);
  std::vector<std::uint8_t> once = film;
  const std::size_t count = tactile::disable_by_default(once);
  expect(count > 0 || once == film);
  std::vector<std::uint8_t> twice = once;
  expect(tactile::disable_by_default(twice) == count);
  expect(twice == once);
  return 0;
}
