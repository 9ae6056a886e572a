// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What has the name of a file and is none: nothing waits for it, and a word says what it is. A test
// that hangs fails by its time limit.
#include "files/regular_file.h"
#include "files/replace.h"

#include "calibration/calibration.h"
#include "chair/settings_file.h"
#include "synth/wave_file.h"
#include "tactor/command_trace.h"
#include "tracks/formats/track_file.h"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "support/check_tests.h"

#include "support/temporary_file.h"

namespace fs = std::filesystem;

namespace {

template <typename Result>
std::string
reason_of(const Result &result)
{
  fail_if(result.has_value());
  if constexpr (requires { result.error().reason; })
    return result.error().reason;
  else if constexpr (requires { result.error().text.size(); })
    return result.error().text;
  else
    return result.error();
}

void
assert_says(const std::string &text, const std::string &word)
{
  fail_unless(text.find(word) != std::string::npos, "no '%s' in '%s'", word.c_str(), text.c_str());
}

} // namespace

CHECK_TEST(test_kinds)
{
  const TemporaryFolder folder;
  const std::string pipe = folder.file("pipe");
  fail_unless(mkfifo(pipe.c_str(), 0600) == 0);
  const std::string socket_path = folder.file("socket");
  const int listening = socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{ .sun_family = AF_UNIX, .sun_path = {} };
  socket_path.copy(address.sun_path, sizeof address.sun_path - 1);
  fail_unless(bind(listening, reinterpret_cast<sockaddr *>(&address), sizeof address) == 0);
  const std::pair<std::string, std::string> kinds[] = {
    { pipe, "got a pipe" },
    { fs::path(pipe).parent_path(), "got a folder" },
    { "/dev/zero", "got a device" },
    { socket_path, "got a socket" },
  };
  for (const auto &[path, word] : kinds)
    assert_says(reason_of(files::read(path, 100)), word);
  close(listening);
  assert_says(reason_of(files::create(pipe)), "got a pipe");
  const auto missing = files::read(folder.file("missing"), 100);
  fail_unless(!missing && missing.error().number == ENOENT);

  const std::string file = folder.file("file");
  std::ofstream(file) << "content";
  const std::string link = folder.file("link");
  fs::create_symlink(file, link);
  fail_unless(files::read(link, 7) == "content");
  assert_says(reason_of(files::read(file, 6)), "larger than the 6 bytes");
  fail_unless(files::create(file).has_value() && files::read(file, 0) == "");
  // One that does not say its size.
  const auto unsized = files::read("/proc/self/status", 1 << 20);
  fail_unless(unsized && unsized->find("Pid:") != std::string::npos);
  assert_says(reason_of(files::read("/proc/self/status", 10)), "larger");
}

/// A pipe that the process was given for its output has a reader. What it has no room for fails.
CHECK_TEST(test_own_output)
{
  int ends[2];
  fail_unless(pipe(ends) == 0);
  const int before = dup(STDOUT_FILENO);
  fail_unless(dup2(ends[1], STDOUT_FILENO) == STDOUT_FILENO);
  auto opened = files::create("/dev/stdout");
  ssize_t written = 0;
  if (opened) {
    const std::string much(1 << 20, 'x');
    written = write(opened->descriptor(), much.data(), much.size());
    if (write(opened->descriptor(), much.data(), 1) >= 0)
      written = -1;
  }
  fail_unless(dup2(before, STDOUT_FILENO) == STDOUT_FILENO);
  close(before);
  fail_unless(opened.has_value(), "refused");
  fail_unless(written > 0 && written < 1 << 20, "%zd bytes", written);
  char first = 0;
  fail_unless(read(ends[0], &first, 1) == 1 && first == 'x');
  // It is somebody else's now.
  assert_says(reason_of(files::create("/proc/self/fd/" + std::to_string(ends[1]))), "got a pipe");
  close(ends[0]);
  close(ends[1]);
}

/// All that is read and written by a name that a user gives.
CHECK_TEST(test_whoever_opens)
{
  const TemporaryFolder folder;
  const auto pipe = [&](const std::string &name) {
    std::string path = folder.file(name.c_str());
    fail_unless(mkfifo(path.c_str(), 0600) == 0);
    return path;
  };
  const std::string others = pipe("others");
  for (const char *name : { "a.vtt", "a.csv", "a.hjif", "a.sem.xml" })
    assert_says(reason_of(tactile::read_track_file(pipe(name))), "got a pipe");
  assert_says(reason_of(chair::SettingsFile::load(others)), "got a pipe");
  assert_says(reason_of(synth::read_wave_file(others)), "got a pipe");
  assert_says(reason_of(tactor::read_calibration(others)), "got a pipe");
  assert_says(reason_of(tactor::read_command_trace(others)), "got a pipe");
  assert_says(reason_of(tactor::CommandTrace::create(others)), "got a pipe");
}

/// What is no file is not replaced by one.
CHECK_TEST(test_replace)
{
  const TemporaryFolder folder;
  const std::string pipe = folder.file("pipe");
  fail_unless(mkfifo(pipe.c_str(), 0600) == 0);
  const std::string part = folder.file("part");
  const auto file = files::create(part);
  fail_unless(file.has_value());
  assert_says(reason_of(files::replace(*file, part, pipe)), "got a pipe");
  fail_unless(fs::is_fifo(pipe) && fs::is_regular_file(part));
  fail_unless(files::replace(*file, part, folder.file("new")).has_value());
}

CHECK_MAIN(regular_file)
