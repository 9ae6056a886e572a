// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Indexes of libraries, and films by their content.
#include "library/library.h"
#include "library/heard.h"
#include "library/track_index.h"
#include "library/web.h"
#include "support/temporary_file.h"

#include <fcntl.h>
#include <fstream>
#include <string>
#include <sys/stat.h>

#include "support/check_tests.h"

using namespace std::chrono_literals;

namespace {

std::string
index_of(const std::string &members)
{
  return "{\"tracks\": [{" + members + "}]}";
}

} // namespace

/// sha256sum of the size, the beginning, the second half and the end: "4", "film", "lm", "film".
CHECK_TEST(test_content)
{
  const TemporaryFile film("film");
  fail_unless(library::film_content(film.path)
              == "69621c5ced61ec395d9e584464853b70fba843d6201764f602842e19ec9e698d");
  fail_unless(library::film_content("/nowhere").empty());
  fail_unless(library::film_content("/tmp").empty());
}

CHECK_TEST(test_index)
{
  const std::vector<library::IndexEntry> entries = {
    { .file = "a b.vtt", .duration = 12500ms, .film = "a b.mkv", .content = std::string(64, 'f') },
    { .file = "below/ü.csv", .duration = 0ms }
  };
  const auto read = library::read_index(library::write_index(entries));
  fail_unless(read && read->size() == 2, "%s", read ? "" : read.error().c_str());
  fail_unless((*read)[0].file == "a b.vtt" && (*read)[0].duration == 12500ms
              && (*read)[0].film == "a b.mkv" && (*read)[0].content == std::string(64, 'f'));
  fail_unless((*read)[1].file == "below/ü.csv" && (*read)[1].content.empty());
}

/// Whatever would lead elsewhere or is out of bounds.
CHECK_TEST(test_hostile)
{
  for (const char *members :
       { "\"file\": \"../a.vtt\", \"duration\": 1", "\"file\": \"/etc/a.vtt\", \"duration\": 1",
         "\"file\": \"a/../../b.vtt\", \"duration\": 1", "\"file\": \".a.vtt\", \"duration\": 1",
         "\"file\": \"a//b.vtt\", \"duration\": 1", "\"file\": \"http://a/b.vtt\", \"duration\": 1",
         "\"file\": \"a\\\\b.vtt\", \"duration\": 1", "\"file\": \"a\\nb.vtt\", \"duration\": 1",
         "\"file\": \"\", \"duration\": 1", "\"file\": \"a.vtt\"",
         "\"file\": \"a.vtt\", \"duration\": -1", "\"file\": \"a.vtt\", \"duration\": 1e9",
         "\"file\": \"a.vtt\", \"duration\": \"1\"",
         "\"file\": \"a.vtt\", \"duration\": 1, \"film\": \"../a.mkv\"",
         "\"file\": \"a.vtt\", \"duration\": 1, \"content\": \"0\"" }) {
    const auto read = library::read_index(index_of(members));
    fail_unless(!read && read.error().starts_with("track 1: expected "), "%s", members);
  }
  for (const char *text :
       { "", "[]", "{}", "{\"tracks\": 1}", "{\"tracks\": [1]}", "{\"tracks\": [" })
    fail_unless(!library::read_index(text), "%s", text);
  fail_unless(!library::read_index(std::string(library::kMostIndex + 1, ' ')));
  std::string many = "{\"tracks\": [0";
  for (int i = 0; i < 100'000; i++)
    many += ",0";
  fail_unless(library::read_index(many + "]}").error().find("at most 100000") != std::string::npos);
}

/// Only http and https, and nothing of the user's in the request.
CHECK_TEST(test_addresses)
{
  for (const char *address :
       { "ftp://host/a", "http://", "http://me:secret@host/a", "http://me@host/a",
         "http://host/a?q", "http://host/a#f", "nothing" }) {
    const auto body = library::fetch(address, 1);
    fail_unless(!body && body.error().find("expected http://HOST") != std::string::npos, "%s",
                address);
  }
  fail_unless(library::is_address("http://host/a") && !library::is_address("/a")
              && !library::is_address("file:///a"));
}

/// A cache of a server's entries keeps to its bytes: what was used last, and what is in use.
CHECK_TEST(test_heard_cache)
{
  const TemporaryFolder folder;
  for (int i = 0; i < 6; i++) {
    const std::string path = folder.file(std::to_string(i).c_str(), std::string(1000, 'x'));
    const timespec times[2] = { { .tv_sec = 1'000'000 - i, .tv_nsec = 0 }, // of access
                                { .tv_sec = 1'000'000 + i, .tv_nsec = 0 } };
    fail_unless(utimensat(AT_FDCWD, path.c_str(), times, 0) == 0);
  }
  library::remove_unused(folder.path, { folder.file("5") }, 3500);
  for (int i = 0; i < 6; i++)
    fail_unless(std::filesystem::exists(folder.file(std::to_string(i).c_str()))
                    == (i == 0 || i == 1 || i == 5),
                "%d", i);
  library::remove_unused(folder.path, { folder.file("5"), folder.file("0") }, 0);
  fail_unless(std::filesystem::exists(folder.file("5")) && std::filesystem::exists(folder.file("0"))
              && !std::filesystem::exists(folder.file("1")));
}

/// Another program that uses an entry of the cache takes it from nobody.
CHECK_TEST(test_heard_used)
{
  const TemporaryFolder folder;
  const auto bytes = listen::write_entry(
      { .film = "a", .track_name = "a.csv", .track = "track", .sound = { .reference = { 1, 2 } } });
  fail_unless(bytes.has_value());
  const std::string path = folder.file("a.heard", *bytes);
  const timespec times[2] = { { .tv_sec = 1000, .tv_nsec = 0 }, { .tv_sec = 1000, .tv_nsec = 0 } };
  fail_unless(utimensat(AT_FDCWD, path.c_str(), times, 0) == 0);
  const auto entry = listen::Entry::open(path);
  fail_unless(entry.has_value());
  library::mark_used(path);
  struct stat found
  {
  };
  fail_unless(stat(path.c_str(), &found) == 0 && found.st_atim.tv_sec > 1000);
  fail_unless(entry->track() == "track" && entry->reference(0, 2).has_value());
}

/// A locked screen does not wait for a catalogue.
CHECK_TEST(test_heard_stop)
{
  const TemporaryFolder folder;
  for (const char *name : { "a.heard", "b.heard" })
    folder.file(name, "torn");
  std::vector<std::string> complaints;
  fail_unless(library::heard_entries(folder.path, complaints).empty() && complaints.size() == 2);
  complaints.clear();
  g_autoptr(GCancellable) stop = g_cancellable_new();
  g_cancellable_cancel(stop);
  fail_unless(library::heard_entries(folder.path, complaints, stop).empty() && complaints.empty());
}

CHECK_MAIN(library)
