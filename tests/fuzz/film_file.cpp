// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Fuzzes disable_by_default(): without a tactile track no byte changes, and a second call finds the
// same tracks and changes nothing.
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
