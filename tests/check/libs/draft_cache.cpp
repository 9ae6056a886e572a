// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Drafts that are kept for the next time.
#include "film/draft_cache.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <unistd.h>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

using namespace std::chrono_literals;
namespace fs = std::filesystem;

namespace {

class Folder
{
public:
  Folder()
  {
    fail_unless(mkdtemp(path_.data()) != nullptr);
  }
  ~Folder()
  {
    std::error_code none;
    fs::remove_all(path_, none);
  }
  Folder(const Folder &) = delete;
  Folder &operator=(const Folder &) = delete;

  std::string operator/(const char *name) const
  {
    return path_ + "/" + name;
  }

private:
  std::string path_ = "/tmp/visuotactile-XXXXXX";
};

/// A film of a megabyte that differs from others in one byte.
std::string
make_film(const std::string &path, std::size_t at, char byte)
{
  std::string bytes(1'000'000, 'f');
  bytes[at] = byte;
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

tactile::Track
track_of(int seconds)
{
  tactile::Track track;
  tactile::TactileMap map(3, 3);
  for (int second = 0; second < seconds; second++) {
    map.levels[static_cast<std::size_t>(second % 9)] = second % 2 == 0 ? 1 : 0;
    fail_unless(track.append(second * 1s, map).has_value());
  }
  fail_unless(track.set_end(seconds * 1s).has_value());
  return track;
}

} // namespace

CHECK_TEST(test_known_by_content)
{
  const Folder folder;
  const DraftCache cache(folder / "drafts");
  const std::string film = make_film(folder / "film.mkv", 0, 'a');
  const AnalysisSettings settings;
  fail_if(cache.find(film, settings).has_value());
  cache.keep(track_of(20), film, library::file_version(film), settings);
  const auto kept = cache.find(film, settings);
  fail_unless(kept.has_value());
  ck_assert(kept->entries() == track_of(20).entries() && kept->end() == 20s);
  // Another name, another time of change.
  fs::copy(film, folder / "copy.mkv");
  fail_unless(cache.find(folder / "copy.mkv", settings).has_value());
  // Other films, by their beginning, middle, end and size.
  fail_if(cache.find(make_film(folder / "b.mkv", 0, 'b'), settings).has_value());
  fail_if(cache.find(make_film(folder / "c.mkv", 510'000, 'b'), settings).has_value());
  fail_if(cache.find(make_film(folder / "d.mkv", 999'999, 'b'), settings).has_value());
  std::ofstream(film, std::ios::app) << "f";
  fail_if(cache.find(film, settings).has_value());
  fail_if(cache.find(folder / "missing.mkv", settings).has_value());
}

/// A film that is still being downloaded is another when it is complete.
CHECK_TEST(test_a_film_that_changes)
{
  const Folder folder;
  const DraftCache cache(folder / "drafts");
  const std::string film = make_film(folder / "film.mkv", 0, 'a');
  const auto is_kept = [&](const std::optional<library::FileVersion> &made_of) {
    try {
      cache.keep(track_of(3), film, made_of, {});
    } catch (const std::runtime_error &) {
      return false;
    }
    return true;
  };
  const auto begun = library::file_version(film);
  std::ofstream(film, std::ios::app) << "f";
  ck_assert(!is_kept(begun));
  // What was a hole is filled, where nobody looks.
  const auto whole = library::file_version(film);
  fail_unless(whole.has_value());
  make_film(film, 300'000, 'b');
  fs::last_write_time(film, whole->changed + 1s);
  ck_assert(!is_kept(whole));
  fail_if(cache.find(film, {}).has_value());
  ck_assert(is_kept(library::file_version(film)));
  fail_unless(cache.find(film, {}).has_value());
  ck_assert(!is_kept(std::nullopt));
}

CHECK_TEST(test_other_settings)
{
  const Folder folder;
  const DraftCache cache(folder / "drafts");
  const std::string film = make_film(folder / "film.mkv", 0, 'a');
  cache.keep(track_of(3), film, library::file_version(film), {});
  fail_if(cache.find(film, { .rate = 10 }).has_value());
  fail_if(cache.find(film, { .rows = 5 }).has_value());
  fail_if(cache.find(film, { .profile = "paper" }).has_value());
  fail_if(cache.find(film, { .sound = fusion::find_profile("film") }).has_value());
  fail_unless(cache.find(film, {}).has_value());
}

CHECK_TEST(test_bounded)
{
  const Folder folder;
  const std::string drafts = folder / "drafts";
  const std::string films[]
      = { make_film(folder / "a.mkv", 0, 'a'), make_film(folder / "b.mkv", 0, 'b'),
          make_film(folder / "c.mkv", 0, 'c') };
  const DraftCache unlimited(drafts);
  unlimited.keep(track_of(100), films[0], library::file_version(films[0]), {});
  const std::uintmax_t size = fs::file_size(unlimited.path(films[0], {}));
  const DraftCache cache(drafts, 5 * size / 2);
  cache.keep(track_of(100), films[1], library::file_version(films[1]), {});
  const auto used = [&](const std::string &film, std::chrono::seconds ago) {
    fs::last_write_time(cache.path(film, {}), fs::file_time_type::clock::now() - ago);
  };
  used(films[0], 200s);
  used(films[1], 100s);
  fail_unless(cache.find(films[0], {}).has_value()); // now the last used
  std::ofstream(drafts + "/notes.txt") << "not a draft";
  cache.keep(track_of(100), films[2], library::file_version(films[2]), {});
  fail_unless(cache.find(films[0], {}).has_value());
  fail_if(cache.find(films[1], {}).has_value());
  fail_unless(cache.find(films[2], {}).has_value());
  ck_assert(fs::exists(drafts + "/notes.txt"));
}

CHECK_TEST(test_damaged)
{
  const Folder folder;
  const DraftCache cache(folder / "drafts");
  const std::string film = make_film(folder / "film.mkv", 0, 'a');
  cache.keep(track_of(3), film, library::file_version(film), {});
  std::ofstream(cache.path(film, {})) << "damaged";
  fail_if(cache.find(film, {}).has_value());
  cache.keep(track_of(3), film, library::file_version(film), {});
  fail_unless(cache.find(film, {}).has_value());
  // No folder can be made in a file.
  const DraftCache nowhere(film + "/drafts");
  bool refused = false;
  try {
    nowhere.keep(track_of(3), film, library::file_version(film), {});
  } catch (const std::runtime_error &error) {
    refused = std::string(error.what()).find(film) != std::string::npos;
  }
  fail_unless(refused);
}

CHECK_MAIN(draft_cache)
