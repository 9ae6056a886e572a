// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What the window and visuotactile-settings say is missing: a package, a udev rule, a login, a
// service, a cable.
#include "house/missing.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/temporary_file.h"

#include "support/check_tests.h"

namespace {

const FoundDevice kBoard{
  .name = "Arduino Uno", .driver = "firmata", .device = "1-2", .bus_path = "1-2"
};
const FoundDevice kPad{ .name = "Bob's pad", .driver = "gamepad", .device = "/dev/input/event3" };
const FoundDevice kCard{ .name = "Speakers", .driver = kAudio, .device = "speakers" };

/// A computer in a folder, with all packages, a board and a gamepad that the user may use.
class Computer
{
public:
  Computer()
  {
    std::filesystem::permissions(root_, std::filesystem::perms(0755)); // for another user, too
    write("sys/bus/usb/devices/1-2/busnum", "1\n");
    write("sys/bus/usb/devices/1-2/devnum", "7\n");
    write("dev/bus/usb/001/007", "");
    write("dev/input/event3", "");
    write("modules/visuotactile-gamepad.so", "");
    write("modules/visuotactile-websocket.so", "");
    write("proc/net/tcp", "");
    write("proc/net/tcp6", "");
  }
  void write(const std::string &name, const std::string &text) const
  {
    std::filesystem::create_directories((root_ / name).parent_path());
    std::ofstream(root_ / name) << text;
    std::filesystem::permissions(root_ / name, std::filesystem::perms(0666));
  }
  void remove(const std::string &name) const
  {
    std::filesystem::remove(root_ / name);
  }
  /// Nobody but root may use it.
  void refuse(const std::string &name) const
  {
    std::filesystem::permissions(root_ / name, std::filesystem::perms::none);
  }
  std::vector<std::string> lines(const std::vector<FoundDevice> &found) const
  {
    const uid_t user = getuid(); // what access() is about
    if (user == 0)
      fail_unless(setreuid(65534, 0) == 0);
    std::vector<std::string> said = missing(found, { .root = root_, .modules = root_ / "modules" });
    if (user == 0)
      fail_unless(setreuid(0, 0) == 0);
    return said;
  }

private:
  const TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.path;
};

void
expect_line(const std::vector<std::string> &lines, const std::string &part)
{
  fail_unless(lines.size() == 1, "expected one line, got %zu", lines.size());
  fail_unless(lines.front().find(part) != std::string::npos, "expected '%s', got '%s'",
              part.c_str(), lines.front().c_str());
}

} // namespace

CHECK_TEST(test_all_is_there)
{
  fail_unless(Computer().lines({ kBoard, kPad, kCard }).empty());
}

CHECK_TEST(test_a_udev_rule)
{
  const Computer computer;
  computer.refuse("dev/bus/usb/001/007");
  expect_line(computer.lines({ kBoard }), "Arduino Uno may not be opened: install the package "
                                          "gstreamer1.0-visuotactile, whose udev rule");
}

CHECK_TEST(test_a_login)
{
  const Computer computer;
  computer.refuse("dev/input/event3");
  expect_line(computer.lines({ kPad }), "log in at the computer itself");
}

CHECK_TEST(test_packages)
{
  const Computer computer;
  computer.remove("modules/visuotactile-gamepad.so");
  expect_line(computer.lines({ kPad }),
              "Bob's pad needs the package gstreamer1.0-visuotactile-gamepad");
  computer.remove("modules/visuotactile-websocket.so");
  // bhaptics Player's port, 15881, in hexadecimal, and state 0A, which listens.
  computer.write("proc/net/tcp", "  sl  local_address rem_address   st\n"
                                 "   0: 0100007F:3E09 00000000:0000 0A 00000000:00000000\n");
  expect_line(computer.lines({ kBoard }),
              "bhaptics needs the package gstreamer1.0-visuotactile-websocket");
}

CHECK_TEST(test_a_service_or_a_cable)
{
  const Computer computer;
  expect_line(computer.lines({}),
              "plug in a board or a gamepad, or start bHaptics Player or Intiface");
  expect_line(computer.lines({ kCard }), "No device is connected"); // each computer has one
  // A connection to that port (01) is no server, one that listens on IPv6 is.
  computer.write("proc/net/tcp", "   0: 0100007F:3039 0100007F:3039 01 00000000:00000000\n");
  expect_line(computer.lines({}), "No device is connected");
  computer.write("proc/net/tcp6", "   0: 00000000000000000000000000000000:3039 "
                                  "00000000000000000000000000000000:0000 0A 00000000:00000000\n");
  fail_unless(computer.lines({}).empty());
}

CHECK_MAIN(missing)
