// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fstream>

#include "desk/session.h"

#include "track_samples.h"

#include "desk/seat.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>

#include "support/check_tests.h"

namespace fs = std::filesystem;
using desk::Refusal;
using desk::Session;
using desk::Splice;

namespace {

constexpr const char *kTrack
    = "WEBVTT\n\nNOTE tactile grid=1x2\n\n00:00:01.000 --> 00:00:02.000\n 50   0\n\nNOTE end\n";

/// A folder of its own with a track, removed with the object.
class Folder
{
public:
  Folder()
  {
    std::string name = (fs::temp_directory_path() / "visuotactile-desk-XXXXXX").string();
    fail_unless(mkdtemp(name.data()) != nullptr);
    path_ = name;
    write("film.vtt", kTrack);
  }
  ~Folder()
  {
    fs::remove_all(path_);
  }
  Folder(const Folder &) = delete;
  Folder &operator=(const Folder &) = delete;

  std::string path(const char *name) const
  {
    return (path_ / name).string();
  }
  std::string read(const char *name) const
  {
    std::ifstream file(path_ / name, std::ios::binary);
    return { std::istreambuf_iterator<char>(file), {} };
  }
  void write(const char *name, const std::string &text) const
  {
    std::ofstream(path_ / name, std::ios::binary) << text;
  }
  std::unique_ptr<Session> open() const
  {
    auto session = Session::open(path("film.vtt"));
    fail_unless(session.has_value(), "%s", session ? "" : session.error().c_str());
    return *std::move(session);
  }

private:
  fs::path path_;
};

/// Gives the only cue another level.
desk::EditMessage
edit(std::uint64_t revision, int level, std::string name = {})
{
  return { .page = "page",
           .edit = name.empty() ? "e" + std::to_string(revision) : std::move(name),
           .revision = revision,
           .splices = { { .at = 0,
                          .remove = 1,
                          .insert = { { .start = 1000,
                                        .end = 2000,
                                        .levels = { static_cast<std::uint8_t>(level), 0 },
                                        .notes = {} } } } } };
}

std::string
with_level(const char *level)
{
  std::string text = kTrack;
  return text.replace(text.find(" 50"), 3, level);
}

} // namespace

/// A session that was killed at any byte of its journal goes on from what was answered.
CHECK_TEST(test_cut_off_anywhere)
{
  const Folder folder;
  std::string journal;
  std::vector<std::size_t> ends; // of what was answered
  {
    const auto session = folder.open();
    for (int i = 0; i < 3; i++) {
      fail_unless(session->edit(edit(static_cast<std::uint64_t>(i), 10 + i)).has_value());
      journal = folder.read("film.vtt.journal");
      ends.push_back(journal.size());
    }
  }
  for (std::size_t size = 0; size <= journal.size(); size++) {
    // A file system takes its time: near the ends of lines, and here and there.
    constexpr std::size_t kNear = 2;
    constexpr std::size_t kHereAndThere = 37;
    const bool is_near = std::ranges::any_of(
        ends, [&](std::size_t end) { return size + kNear >= end && size <= end + kNear; });
    if (!is_near && size % kHereAndThere != 0)
      continue;
    folder.write("film.vtt.journal", journal.substr(0, size));
    const auto session = folder.open();
    const auto whole = static_cast<std::uint64_t>(
        std::ranges::count_if(ends, [&](std::size_t end) { return end <= size; }));
    fail_unless(session->revision() == whole, "%zu of %zu bytes", size, journal.size());
    fail_unless(session->document().cues()[0].levels[0] == (whole > 0 ? 9 + whole : 50));
    fail_unless(session->messages().empty() == (whole == 0));
    // It goes on from there.
    fail_unless(session->edit(edit(whole, 77, "next")).has_value());
  }
  const auto session = folder.open();
  fail_unless(session->revision() == 4 && session->document().cues()[0].levels[0] == 77);
  // The answer was lost, and the page asks again after the start.
  fail_unless(session->edit(edit(3, 77, "next")).has_value() && session->revision() == 4);
  ASSERT_TEXT(folder.read("film.vtt"), kTrack);
}

CHECK_TEST(test_save)
{
  const Folder folder;
  {
    const auto session = folder.open();
    fail_unless(session->save()->kept.empty());
    fail_unless(session->edit(edit(0, 60)).has_value());
    fail_unless(session->edit(edit(0, 61, "other")).error().kind == Refusal::Kind::stale);
    desk::EditMessage wrong = edit(1, 62);
    wrong.splices[0].remove = 2;
    fail_unless(session->edit(wrong).error().kind == Refusal::Kind::invalid);
    ASSERT_TEXT(session->save()->kept, "film.vtt.desk~1~");
    fail_unless(session->saved() == 1);
    fail_unless(folder.read("film.vtt") == with_level(" 60"));
    ASSERT_TEXT(folder.read("film.vtt.desk~1~"), kTrack);
    fail_unless(folder.read("film.vtt.journal").empty());
    fail_unless(session->edit(edit(1, 50)).has_value() && session->save().has_value());
    ASSERT_TEXT(folder.read("film.vtt"), kTrack);
  }
  fail_if(fs::exists(folder.path("film.vtt.journal")));
}

/// A save that was cut off after the file was written, before the journal was emptied.
CHECK_TEST(test_cut_off_save)
{
  const Folder folder;
  {
    const auto session = folder.open();
    fail_unless(session->edit(edit(0, 60)).has_value());
  }
  folder.write("film.vtt", with_level(" 60"));
  const auto session = folder.open();
  fail_unless(session->revision() == 0 && session->messages().empty());
  fail_if(fs::exists(folder.path("film.recovered.vtt")));
}

CHECK_TEST(test_another_program)
{
  const Folder folder;
  for (const char *name : { "film.recovered.vtt", "film.recovered-2.vtt" }) {
    folder.write("film.vtt", kTrack);
    {
      const auto session = folder.open();
      fail_unless(session->edit(edit(0, 60)).has_value());
      fail_unless(!Session::open(folder.path("film.vtt")), "two sessions at once");
    }
    folder.write("film.vtt", with_level(" 70"));
    const auto session = folder.open();
    fail_unless(session->document().cues()[0].levels[0] == 70 && session->messages().size() == 1);
    fail_unless(folder.read(name) == with_level(" 60"));
  }
}

/// What another program writes while the track is open is not replaced without a word.
CHECK_TEST(test_changed_outside)
{
  const Folder folder;
  {
    const auto session = folder.open();
    fail_unless(session->edit(edit(0, 60)).has_value());
    folder.write("film.vtt", with_level(" 70"));
    const auto refused = session->save();
    fail_unless(!refused && refused.error().kind == Refusal::Kind::changed);
    fail_unless(folder.read("film.vtt") == with_level(" 70"));
    fail_unless(session->saved() == 0 && session->revision() == 1);
    ASSERT_TEXT(session->save(true)->kept, "film.vtt.desk~1~");
    fail_unless(folder.read("film.vtt") == with_level(" 60"));
    fail_unless(folder.read("film.vtt.desk~1~") == with_level(" 70"));
    // Without an edit, too.
    folder.write("film.vtt", with_level(" 71"));
    fail_unless(session->save().error().kind == Refusal::Kind::changed);
    // Nothing is replaced if it is gone, or says the same.
    fs::remove(folder.path("film.vtt"));
    fail_unless(session->save()->kept.empty());
    fail_unless(session->edit(edit(1, 80)).has_value());
    folder.write("film.vtt", with_level(" 80"));
    fail_unless(session->save().has_value());
  }
  fail_if(fs::exists(folder.path("film.vtt.journal")));
}

CHECK_TEST(test_damaged)
{
  const Folder folder;
  folder.write("film.vtt.journal", "something else\n");
  fail_unless(folder.open()->messages().size() == 1);
  ASSERT_TEXT(folder.read("film.vtt.journal.damaged-1"), "something else\n");
  {
    const auto session = folder.open();
    fail_unless(session->edit(edit(0, 60)).has_value());
  }
  folder.write("film.vtt.journal", folder.read("film.vtt.journal") + "{}\n" + "{}\n");
  fail_unless(folder.open()->revision() == 1);
  fail_unless(folder.open()->messages().size() == 1, "only what is right is left");
  fail_unless(folder.read("film.vtt.journal.damaged-2").ends_with("{}\n{}\n"));
}

CHECK_TEST(test_refused)
{
  const Folder folder;
  folder.write("film.csv", "# tactile grid=1x1\ntime_ms,t0\n0,1\n");
  folder.write("words.vtt", "WEBVTT\n\n00:01.000 --> 00:02.000\nHello\n");
  for (const char *name : { "none.vtt", "film.csv", "words.vtt" }) {
    const auto session = Session::open(folder.path(name));
    fail_unless(!session && session.error().find(name) != std::string::npos);
    fail_if(fs::exists(folder.path(name) + ".journal"));
  }
}

CHECK_TEST(test_link)
{
  const Folder folder;
  fs::create_directory(folder.path("other"));
  fs::rename(folder.path("film.vtt"), folder.path("other/film.vtt"));
  fs::create_symlink("other/film.vtt", folder.path("film.vtt"));
  const auto session = folder.open();
  fail_unless(session->edit(edit(0, 60)).has_value() && session->save().has_value());
  fail_unless(fs::is_symlink(folder.path("film.vtt")));
  fail_unless(folder.read("other/film.vtt") == with_level(" 60"));
}

CHECK_TEST(test_seat)
{
  desk::Seat seat;
  fail_if(seat.take("a", true));
  seat.listens("a");
  seat.listens("b");
  fail_unless(seat.take("a", false) && seat.take("a", false));
  fail_if(seat.take("b", false));
  fail_unless(seat.take("b", true) && seat.has("b") && !seat.has("a"));
  seat.give("a");
  fail_unless(seat.has("b"));
  // It loads again: the new stream begins before the old one has ended.
  seat.listens("b");
  fail_if(seat.left("b"));
  fail_unless(seat.has("b"));
  fail_unless(seat.left("b"));
  fail_if(seat.writer());
  fail_if(seat.left("b"));
  fail_unless(seat.take("a", false));
}

CHECK_MAIN(desk_session)
