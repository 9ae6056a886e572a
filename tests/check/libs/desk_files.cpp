// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The desk's files and its journal on disks that fail, and beside other programs. The system's
// calls are this program's own, so that they can fail.
#include <fstream>

#include "desk/files.h"
#include "desk/session.h"
#include "files/whole_file.h"

#include "track_samples.h"

#include <cerrno>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <functional>
#include <iterator>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <utility>

#include "support/check_tests.h"

namespace fs = std::filesystem;
using files::Journal;

namespace {

/// What the next calls do; without, what they always do.
struct Calls
{
  std::function<int(int)> fsync;
  std::function<int()> link;
  std::function<int()> chmod;
  std::function<void()> before_lock;
} calls;

int
failing(int error)
{
  errno = error;
  return -1;
}

/// A folder of its own, removed with the object.
class Folder
{
public:
  Folder()
  {
    std::string name = (fs::temp_directory_path() / "visuotactile-desk-XXXXXX").string();
    fail_unless(mkdtemp(name.data()) != nullptr);
    path_ = name;
    calls = {};
  }
  ~Folder()
  {
    calls = {};
    fs::remove_all(path_);
  }
  Folder(const Folder &) = delete;
  Folder &operator=(const Folder &) = delete;

  std::string path(const std::string &name) const
  {
    return (path_ / name).string();
  }
  std::string read(const std::string &name) const
  {
    std::ifstream file(path_ / name, std::ios::binary);
    return { std::istreambuf_iterator<char>(file), {} };
  }
  void write(const std::string &name, const std::string &text) const
  {
    std::ofstream(path_ / name, std::ios::binary) << text;
  }
  Journal journal() const
  {
    auto journal = Journal::open(path("journal"), desk::kJournal);
    fail_unless(journal.has_value(), "%s", journal ? "" : journal.error().c_str());
    return *std::move(journal);
  }

private:
  fs::path path_;
};

bool
is_folder(int descriptor)
{
  struct stat status
  {
  };
  return fstat(descriptor, &status) == 0 && S_ISDIR(status.st_mode);
}

} // namespace

#pragma GCC visibility push(default)
extern "C" {

int
fsync(int descriptor)
{
  return calls.fsync ? calls.fsync(descriptor) : static_cast<int>(syscall(SYS_fsync, descriptor));
}

int
fchmod(int descriptor, mode_t mode) noexcept
{
  return calls.chmod ? calls.chmod() : static_cast<int>(syscall(SYS_fchmod, descriptor, mode));
}

int
link(const char *from, const char *to) noexcept
{
  return calls.link ? calls.link()
                    : static_cast<int>(syscall(SYS_linkat, AT_FDCWD, from, AT_FDCWD, to, 0));
}

int
flock(int descriptor, int operation) noexcept
{
  if (calls.before_lock)
    std::exchange(calls.before_lock, {})();
  return static_cast<int>(syscall(SYS_flock, descriptor, operation));
}
}
#pragma GCC visibility pop

CHECK_TEST(test_cleared_but_not_on_disk)
{
  const Folder folder;
  Journal journal = folder.journal();
  fail_unless(journal.append("base one", "edit one").has_value());
  calls.fsync = [](int) {
    return failing(EIO);
  };
  fail_unless(!journal.clear());
  calls = {};
  // It is empty all the same: what follows begins with its base.
  fail_unless(journal.is_empty());
  fail_unless(journal.append("base two", "edit two").has_value());
  const auto content = journal.read();
  fail_unless(content && !content->damaged && content->base == "base two");
  fail_unless(content->entries == std::vector<std::string>{ "edit two" });
}

/// The desk before ends between this one's open() and flock().
CHECK_TEST(test_lock_of_a_removed_file)
{
  const Folder folder;
  folder.write("journal", "");
  calls.before_lock = [&] {
    fs::remove(folder.path("journal"));
  };
  Journal journal = folder.journal();
  fail_if(calls.before_lock);
  fail_unless(journal.append("base", "edit").has_value());
  fail_unless(folder.read("journal").ends_with("edit\n"));
  fail_unless(!Journal::open(folder.path("journal"), desk::kJournal), "two desks at once");
}

CHECK_TEST(test_journal_is_bounded)
{
  constexpr std::size_t kLarge = (std::size_t{ 1 } << 30) + 1;
  const Folder folder;
  {
    Journal journal = folder.journal();
    // Addresses alone: it is refused before it is read.
    void *memory
        = mmap(nullptr, kLarge, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    fail_unless(memory != MAP_FAILED);
    const auto appended
        = journal.append("base", { static_cast<const char *>(memory), kLarge - 20 });
    fail_unless(!appended && appended.error().find("save") != std::string::npos);
    munmap(memory, kLarge);
    fail_unless(journal.is_empty() && journal.append("base", "edit").has_value());
  }
  // One that is there all the same is no reason not to open the track.
  fail_unless(truncate(folder.path("journal").c_str(), static_cast<off_t>(kLarge)) == 0);
  Journal journal = folder.journal();
  const auto content = journal.read();
  fail_unless(content && content->damaged);
  const auto aside = journal.set_aside();
  fail_unless(aside && fs::file_size(*aside) == kLarge);
  fail_unless(journal.append("base", "edit").has_value());
}

/// FAT has neither permissions nor links.
CHECK_TEST(test_fat)
{
  const Folder folder;
  folder.write("film.vtt", "old");
  folder.write("journal", "damaged\n");
  calls.link = [] {
    return failing(EPERM);
  };
  const auto kept = desk::keep_version(folder.path("film.vtt"), 20);
  fail_unless(kept.has_value(), "%s", kept ? "" : kept.error().c_str());
  ASSERT_TEXT(folder.read(*kept), "old");
  calls.chmod = [] {
    return failing(EPERM);
  };
  const auto written = files::replace_file(folder.path("film.vtt"), "new");
  fail_unless(written && written->empty(), "%s", written ? "" : written.error().c_str());
  fail_unless(folder.read("film.vtt") == "new");
  Journal journal = folder.journal();
  const auto aside = journal.set_aside();
  fail_unless(aside.has_value(), "%s", aside ? "" : aside.error().c_str());
  fail_unless(folder.read("journal.damaged-1") == "damaged\n");
}

/// A file that is in place is no failure, whatever the disk says then.
CHECK_TEST(test_folder_not_on_disk)
{
  const Folder folder;
  folder.write("film.vtt", "old");
  calls.fsync = [](int descriptor) {
    return is_folder(descriptor) ? failing(EIO) : static_cast<int>(syscall(SYS_fsync, descriptor));
  };
  const auto written = files::replace_file(folder.path("film.vtt"), "new");
  fail_unless(written && !written->empty());
  fail_unless(folder.read("film.vtt") == "new");
  // Before that, nothing has changed.
  calls.fsync = [](int) {
    return failing(EIO);
  };
  fail_unless(!files::replace_file(folder.path("film.vtt"), "newer"));
  fail_unless(folder.read("film.vtt") == "new");
  fail_unless(std::distance(fs::directory_iterator(folder.path("")), {}) == 1);
}

/// Emacs and cp --backup=numbered have their own versions.
CHECK_TEST(test_versions_of_others)
{
  const Folder folder;
  for (int i = 1; i <= 30; i++) {
    const std::string name = "film.vtt.~" + std::to_string(i) + "~";
    folder.write(name, "theirs");
    folder.write("film.vtt", std::to_string(i));
    fail_unless(desk::keep_version(folder.path("film.vtt"), 3)
                == "film.vtt.desk~" + std::to_string(i) + "~");
  }
  for (int i = 1; i <= 30; i++) {
    fail_unless(folder.read("film.vtt.~" + std::to_string(i) + "~") == "theirs");
    fail_unless(fs::exists(folder.path("film.vtt.desk~" + std::to_string(i) + "~")) == (i > 27));
  }
}

CHECK_MAIN(desk_files)
