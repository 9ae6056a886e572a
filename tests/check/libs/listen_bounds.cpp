// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A catalogue of many films, and entries that say what cannot be, within bounds of files, memory
// and belief.
#include "listen/catalogue.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <sys/resource.h>
#include <vector>

#include "support/temporary_file.h"
#include "support/unwrap.h"

#include "support/check_tests.h"

namespace {

/// `seconds` of film with `count` hashes at `frame`.
listen::FilmSound
crowd(std::size_t seconds, int count, std::int64_t frame = 0)
{
  listen::FilmSound made{ .reference = std::vector<std::uint8_t>(250 * seconds) };
  for (int i = 0; i < count; i++)
    made.hashes.push_back({ .frame = frame, .value = static_cast<std::uint32_t>(i) % 1024 });
  return made;
}

std::string
entry(const std::string &film, const listen::FilmSound &sound)
{
  return unwrap(listen::write_entry(
      { .film = film, .track_name = "a.csv", .track = "track of " + film, .sound = sound }));
}

} // namespace

/// More films than a process may have files open.
CHECK_TEST(test_files)
{
  const TemporaryFolder folder;
  rlimit before{};
  fail_unless(getrlimit(RLIMIT_NOFILE, &before) == 0);
  const rlimit few{ .rlim_cur = 64, .rlim_max = before.rlim_max };
  fail_unless(setrlimit(RLIMIT_NOFILE, &few) == 0);
  std::vector<listen::Entry> films;
  for (int i = 0; i < 200; i++) {
    const std::string name = std::to_string(i) + ".heard";
    films.push_back(unwrap(listen::Entry::open(
        folder.file(name.c_str(), entry(name, crowd(static_cast<std::size_t>(i) + 1, 3))))));
  }
  const listen::Catalogue catalogue(std::move(films));
  fail_unless(catalogue.films().size() == 200);
  for (const listen::Entry &film : catalogue.films()) {
    fail_unless(film.track() == "track of " + film.film());
    fail_unless(film.hashes(0).size() == 3);
  }
  fail_unless(setrlimit(RLIMIT_NOFILE, &before) == 0);
}

/// Another file of its name is not read as the entry that it was.
CHECK_TEST(test_replaced)
{
  const TemporaryFolder folder;
  const std::string path = folder.file("a.heard", entry("a", crowd(1, 3)));
  const auto film = unwrap(listen::Entry::open(path));
  fail_unless(film.track() == "track of a");
  std::filesystem::rename(folder.file("b.heard", entry("b", crowd(1, 3))), path);
  fail_if(film.track().has_value() || film.reference(0, 10).has_value());
  fail_unless(film.hashes(0).empty());
  std::filesystem::remove(path);
  fail_if(film.track().has_value());
}

/// Of a second no more hashes count than tactile-track learn writes.
CHECK_TEST(test_crowded)
{
  const auto film = unwrap(listen::Entry::of(entry("a", crowd(2, 100'000, 70))));
  for (unsigned rank = 0; rank < listen::kRanks; rank++)
    fail_unless(film.hashes(rank).size() == static_cast<std::size_t>(listen::kOfRank[rank]),
                "rank %u: %zu", rank, film.hashes(rank).size());
  const listen::Catalogue catalogue(std::vector<listen::Entry>{ film });
  fail_unless(catalogue.index().bytes() < (std::size_t{ 3 } << 20), "%zu bytes",
              catalogue.index().bytes());
}

/// Films without room are left out.
CHECK_TEST(test_room)
{
  constexpr std::size_t kMost = std::size_t{ 3 } << 20;
  const std::vector<std::int64_t> films(2000, 62 * 600);
  const listen::HashIndex index(
      films, [](std::size_t, unsigned) { return std::vector<listen::RankedHash>(1780); }, kMost);
  fail_unless(index.bytes() <= kMost, "%zu bytes", index.bytes());
  fail_unless(index.films() > 50 && index.films() < 200, "%zu films", index.films());
}

/// A listener that ends does not wait for its catalogue.
CHECK_TEST(test_stops)
{
  const std::vector<listen::Entry> films{ unwrap(listen::Entry::of(entry("a", crowd(1, 3)))) };
  fail_unless(listen::Catalogue(films).films().size() == 1);
  const listen::Catalogue none(films, listen::Catalogue::kMostBytes, [] { return true; });
  fail_unless(none.films().empty() && none.complaints().empty());
}

CHECK_MAIN(listen_bounds)
