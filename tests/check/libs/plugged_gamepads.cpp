// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/plugged_gamepads.h"

#include "support/temporary_file.h"

#include <filesystem>
#include <fstream>

#include "support/check_tests.h"

using namespace tactor;

namespace {

void
write(const std::filesystem::path &file, const std::string &line)
{
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file) << line << '\n';
}

/// An input device as in sysfs.
void
plug(const std::filesystem::path &node, const std::string &keys, const std::string &effects)
{
  write(node / "device/name", "Xbox Wireless Controller");
  write(node / "device/id/vendor", "045e");
  write(node / "device/id/product", "0b13");
  write(node / "device/id/bustype", "0005");
  write(node / "device/capabilities/key", keys);
  write(node / "device/capabilities/ff", effects);
}

// Of an Xbox gamepad on a 64-bit kernel.
constexpr const char *kButtons = "7cdb000000000000 0 0 0 0";
constexpr const char *kEffects = "107030000 0";

} // namespace

CHECK_TEST(test_gamepads)
{
  const TemporaryFolder input;
  const std::filesystem::path sys = input.path;
  plug(sys / "event7", kButtons, kEffects);
  plug(sys / "event5", kButtons, kEffects);
  plug(sys / "event1", "10000 0 0 0 0", kEffects);    // a mouse
  plug(sys / "event2", kButtons, "0");                // no force feedback
  plug(sys / "event3", kButtons, "200000000");        // no word for rumble
  plug(sys / "js0", kButtons, kEffects);              // the same gamepads, other interface
  write(sys / "event4/device/capabilities/key", "x"); // not a number
  const std::vector<Gamepad> gamepads = plugged_gamepads(sys);
  ck_assert_uint_eq(gamepads.size(), 2);
  const Gamepad first{ .name = "Xbox Wireless Controller",
                       .path = "/dev/input/event5",
                       .vendor = 0x045e,
                       .product = 0x0b13,
                       .is_bluetooth = true };
  fail_unless(gamepads[0] == first);
  fail_unless(gamepads[1].path == "/dev/input/event7");
}

CHECK_TEST(test_no_input_devices)
{
  fail_unless(plugged_gamepads("/nowhere").empty());
}

CHECK_MAIN(plugged_gamepads)
