// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Fuzzes entries of the catalogue of films by their sound: what is read lies within the film and
// the file, and can be listened for. Other input is refused with a reason.
#include "listen/listener.h"

#include "fuzz.h"

#include <algorithm>
#include <utility>

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  auto entry = listen::Entry::of({ reinterpret_cast<const char *>(data), size });
  if (!entry) {
    expect(!entry.error().empty());
    return 0;
  }
  const auto most = static_cast<std::int64_t>(size);
  expect(entry->film().find('/') == std::string::npos && entry->track()->size() <= size);
  for (const listen::RankedHash &hash : entry->hashes(listen::kRanks - 1))
    expect(hash.frame >= 0 && hash.frame <= most && hash.value < 1U << listen::kHashBits);
  for (const std::int64_t from : { -most - 3, std::int64_t{ -1 }, most / 2, most + 5 })
    expect(entry->reference(from, 7)->size() == 7);
  const std::vector<listen::RankedHash> hashes = entry->hashes(0);
  std::vector<listen::Entry> films;
  films.push_back(*std::move(entry));
  const listen::Catalogue catalogue(std::move(films));
  std::vector<listen::Hash> heard;
  for (const listen::RankedHash &hash : hashes)
    heard.push_back({ .frame = hash.frame, .value = hash.value });
  for (const listen::Place &place : catalogue.index().search(heard, 4).places)
    expect(place.film == 0);
  return 0;
}
