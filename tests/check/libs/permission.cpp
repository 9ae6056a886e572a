// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/serial/permission.h"

#include "support/contains.h"
#include "system_tree.h"

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

using namespace tactor;

/// No rule is installed, the rule is newer than the board, or the rule gives access only to users
/// at the machine.
CHECK_TEST(test_advice)
{
  const SystemTree machine;
  machine.write(machine.roots.sys / "bus/usb/devices/1-2/dev", "189:5\n");
  machine.write(machine.roots.udev_data / "c189:5", "I:123\nE:ID_VENDOR=Arduino\nG:seat\n");
  assert_contains(permission_advice("1-2", machine.roots),
                  { "install the udev rule: ",
                    "sudo install -m 644 data/udev/70-visuotactile.rules "
                    "/etc/udev/rules.d/",
                    "udevadm control --reload", "udevadm trigger" });

  machine.write(machine.roots.rules[1] / "70-visuotactile.rules", "");
  std::string advice = permission_advice("1-2", machine.roots);
  assert_contains(advice, { "installed, but was not applied", "udevadm trigger", "plug it out" });
  fail_unless(advice.find("sudo install") == std::string::npos);

  for (const char *mark : { "Q:uaccess", "G:uaccess" }) {
    machine.write(machine.roots.udev_data / "c189:5",
                  std::string("I:123\nG:seat\n") + mark + "\nV:1\n");
    advice = permission_advice("1-2", machine.roots);
    assert_contains(advice, { "to the user at the computer", "from elsewhere", "ssh",
                              "log in at the computer", "VISUOTACTILE_BOARD", "GROUP=\"plugdev\"",
                              "/etc/udev/rules.d/71-visuotactile-group.rules",
                              "usermod -aG plugdev", "udevadm control --reload" });
    fail_unless(advice.find("sudo install") == std::string::npos);
    fail_unless(advice.find('\n') == std::string::npos);
  }
  // udev does not know the device in the other socket.
  assert_contains(permission_advice("1-3", machine.roots), { "was not applied" });
}

CHECK_MAIN(permission)
