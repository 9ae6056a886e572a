// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/known_boards.h"
#include "tactor/drivers/last_device.h"

#include "support/temporary_file.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <sys/stat.h>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

using namespace tactor;

namespace {

SerialDevice
adapter(const char *serial, const char *bus_path)
{
  return { .serial = serial, .bus_path = bus_path, .vendor = 0x0403, .product = 0x6001 };
}

std::string
contents(const std::filesystem::path &path)
{
  std::ifstream file(path);
  return { std::istreambuf_iterator<char>(file), {} };
}

} // namespace

/// Known by serial number in any socket, or by socket if there is no number.
CHECK_TEST(test_remembers)
{
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.file("state/visuotactile/boards");
  KnownBoards boards(file);
  fail_if(boards.has(adapter("A5", "1-1")));
  boards.add(adapter("A5", "1-1"));
  boards.add(adapter("", "1-2"));
  boards.add(adapter("A5", "1-1"));
  fail_unless(contents(file) == "0403:6001 at 1-2\n0403:6001 serial A5\n");

  const KnownBoards again(file);
  fail_unless(again.has(adapter("A5", "3-1")));
  fail_unless(again.has(adapter("", "1-2")));
  fail_if(again.has(adapter("", "1-1")));
  fail_if(again.has(adapter("A", "1-1")));
  SerialDevice other = adapter("A5", "1-1");
  other.product = 0x6015;
  fail_if(again.has(other));

  // One that is none, until it answers.
  boards.refuse(adapter("A5", "1-1"));
  fail_unless(contents(file) == "0403:6001 at 1-2\nnot 0403:6001 serial A5\n");
  fail_if(again.has(adapter("A5", "1-1")));
  fail_unless(again.has_refused(adapter("A5", "2-1")) && !again.has_refused(adapter("", "1-2")));
  fail_unless(again.has(adapter("", "1-2")));
  boards.add(adapter("A5", "1-1"));
  fail_unless(again.has(adapter("A5", "1-1")) && !again.has_refused(adapter("A5", "1-1")));
}

CHECK_TEST(test_limited_number)
{
  const TemporaryFolder folder;
  KnownBoards boards(folder.file("boards"));
  for (int i = 0; i <= static_cast<int>(KnownBoards::kMost); i++)
    boards.add(adapter(std::to_string(i).c_str(), "1-1"));
  fail_if(boards.has(adapter("0", "1-1"))); // the oldest
  fail_unless(boards.has(adapter("1", "1-1")));
  fail_unless(boards.has(adapter(std::to_string(KnownBoards::kMost).c_str(), "1-1")));
  // An entry that would not be one line is not kept.
  boards.add(adapter("a\nb", "1-1"));
  boards.add(adapter(std::string(5000, 'x').c_str(), "1-1"));
  fail_if(boards.has(adapter("a\nb", "1-1")));
  fail_if(boards.has(adapter(std::string(5000, 'x').c_str(), "1-1")));
}

/// Missing, huge and unrelated files: no board is known, and nothing blocks.
CHECK_TEST(test_invalid_files)
{
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.file("boards");
  KnownBoards boards(file);
  std::ofstream(file) << std::string(100, '\0') << "\n\n0403:6001 serial A5\nnonsense\n";
  fail_unless(boards.has(adapter("A5", "1-1")));
  std::ofstream(file) << std::string(1 << 20, 'x') << "\n0403:6001 serial A5\n";
  fail_if(boards.has(adapter("A5", "1-1")));
  std::filesystem::remove(file);
  fail_unless(mkfifo(file.c_str(), 0600) == 0);
  fail_if(boards.has(adapter("A5", "1-1")));
  std::filesystem::remove(file);
  std::filesystem::create_directory(file);
  std::ofstream(file / "in the way");
  boards.add(adapter("A5", "1-1"));
  fail_if(boards.has(adapter("A5", "1-1")));

  KnownBoards nowhere("/proc/no/such/folder/boards");
  nowhere.add(adapter("A5", "1-1"));
  fail_if(nowhere.has(adapter("A5", "1-1")));
  KnownBoards none("");
  none.add(adapter("A5", "1-1"));
  fail_if(none.has(adapter("A5", "1-1")));
}

/// The path that the XDG base directory specification gives.
CHECK_TEST(test_default_file)
{
  setenv("HOME", "/home/a", 1);
  unsetenv("XDG_STATE_HOME");
  fail_unless(KnownBoards::default_file() == "/home/a/.local/state/visuotactile/boards");
  setenv("XDG_STATE_HOME", "/var/b", 1);
  fail_unless(KnownBoards::default_file() == "/var/b/visuotactile/boards");
  setenv("XDG_STATE_HOME", "relative", 1);
  fail_unless(KnownBoards::default_file() == "/home/a/.local/state/visuotactile/boards");
  unsetenv("HOME");
  fail_unless(KnownBoards::default_file().empty());
}

/* ---- the last device ---- */

CHECK_TEST(test_last_device)
{
  const TemporaryFile file;
  fail_if(last_device(file.path));
  const LastDevice pad{ .driver = "gamepad",
                        .device = "",
                        .board = "Bob's pad (/dev/input/event3)" };
  remember_device(pad, file.path);
  fail_unless(last_device(file.path) == pad);
  // What is no line of a device is not stored, and a file of anything else is none.
  remember_device({ .driver = "gamepad", .device = "a\nb", .board = "pad" }, file.path);
  remember_device({ .driver = "GAME PAD", .device = "", .board = "pad" }, file.path);
  remember_device({ .driver = "gamepad", .device = "", .board = "" }, file.path);
  fail_unless(last_device(file.path) == pad);
  for (const std::string &text :
       { std::string("gamepad\n\npad\nmore\n"), std::string("gamepad\n\n"),
         std::string("\n\npad\n"), std::string("gamepad\n\n\x1b[2J\n"), std::string(8192, 'a') }) {
    std::ofstream(file.path) << text;
    fail_if(last_device(file.path));
  }
}

CHECK_MAIN(known_boards)
