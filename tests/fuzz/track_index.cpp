// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Fuzzes the index of a library of tracks, which a server sends: one that is read has bounded
// values, and is written and read as it is. Other input is refused with a reason.
#include "library/track_index.h"
#include "fuzz.h"

#include <string_view>

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  const auto read = library::read_index({ reinterpret_cast<const char *>(data), size });
  if (!read) {
    expect(!read.error().empty());
    return 0;
  }
  for (const library::IndexEntry &entry : *read) {
    expect(!entry.file.empty() && entry.file.find("..") != 0
           && entry.file.find("/..") == std::string::npos);
    expect(entry.film.find('/') == std::string::npos);
    expect(entry.duration.count() >= 0 && entry.duration <= std::chrono::hours(100));
  }
  const auto again = library::read_index(library::write_index(*read));
  expect(again.has_value() && again->size() == read->size());
  for (std::size_t i = 0; i < read->size(); i++)
    expect((*again)[i].file == (*read)[i].file && (*again)[i].film == (*read)[i].film
           && (*again)[i].content == (*read)[i].content);
  return 0;
}
