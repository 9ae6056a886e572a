// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The driver of gamepads with SDL and its virtual gamepad, whose motors are callbacks here.
#include "tactor/drivers/registry.h"

#include "refused.h"
#include "support/contains.h"
#include "support/unwrap.h"
#include "support/virtual_gamepad.h"

#include <algorithm>
#include <array>
#include <condition_variable>
#include <mutex>

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;

namespace {

constexpr std::array<int, 4> kZero{};

} // namespace

CHECK_TEST(test_motors)
{
  VirtualPad pad("virtual pad");
  const auto driver = unwrap(make_driver("gamepad"));
  unwrap(driver->open({ .device = "virtual pad", .full_scale_volts = 3 }));
  ck_assert_int_eq(driver->tactors(), 4);
  unwrap(driver->write(std::array{ 3.0, 1.5, 0.0, 0.75 }, 0s));
  pad.wait_for({ 65535, 32768, 0, 16384 });
  driver->close();
  fail_unless(pad.levels() == kZero);
}

/// Without another write() SDL stops the motors.
CHECK_TEST(test_watchdog)
{
  VirtualPad pad("virtual pad");
  const auto driver = unwrap(make_driver("gamepad"));
  unwrap(driver->open({ .device = "virtual pad" }));
  unwrap(driver->write(std::array{ 3.0, 3.0, 3.0, 3.0 }, 0s));
  pad.wait_for({ 65535, 65535, 65535, 65535 });
  pad.wait_for(kZero);
  unwrap(driver->write(std::array{ 3.0, 3.0, 3.0, 3.0 }, 0s));
  pad.wait_for({ 65535, 65535, 65535, 65535 });
}

/// A pad may run from before: the first thing it is sent is a zero, though SDL takes it for silent.
CHECK_TEST(test_zero_at_first)
{
  VirtualPad pad("virtual pad");
  const auto driver = unwrap(make_driver("gamepad"));
  unwrap(driver->open({ .device = "virtual pad" }));
  unwrap(driver->write(std::array{ 3.0, 3.0, 0.0, 0.0 }, 0s));
  pad.wait_for({ 65535, 65535, 0, 0 });
  const auto history = pad.history();
  const auto zero = std::ranges::find(history, std::array{ 0, 0 });
  fail_unless(zero != history.end());
  fail_unless(std::ranges::all_of(history.begin(), zero, [](const auto &levels) {
    return levels == std::array{ 1, 1 };
  }));
}

/// A rumble that fails may have begun: SDL 3 takes the pad for silent then.
CHECK_TEST(test_zero_after_a_failure)
{
  VirtualPad pad("virtual pad", false);
  const auto driver = unwrap(make_driver("gamepad"));
  unwrap(driver->open({ .device = "virtual pad" }));
  pad.fail_once();
  unwrap(driver->write(std::array{ 3.0, 3.0 }, 0s));
  pad.wait_for({ 65535, 65535, 0, 0 });
  pad.wait_for(kZero);
  driver->close();
  fail_unless(pad.levels() == kZero);
}

/// Two drivers take two gamepads; there is no third.
CHECK_TEST(test_several)
{
  VirtualPad left("left pad");
  VirtualPad right("right pad", false);
  const auto first = unwrap(make_driver("gamepad"));
  const auto second = unwrap(make_driver("gamepad"));
  const auto third = unwrap(make_driver("gamepad"));
  unwrap(first->open({ .device = "right pad" }));
  ck_assert_int_eq(first->tactors(), 2);
  unwrap(second->open({ .device = "left pad" }));
  unwrap(first->write(std::array{ 3.0, 0.0 }, 0s));
  right.wait_for({ 65535, 0, 0, 0 });
  unwrap(second->write(std::array{ 0.0, 3.0 }, 0s));
  left.wait_for({ 0, 65535, 0, 0 });
  fail_unless(refusal_of(third->open({ .device = "left pad" })).kind == DriverError::Kind::busy);
  second->close();
  fail_unless(left.levels() == kZero);
  unwrap(third->open({ .device = "left pad" }));
}

CHECK_TEST(test_unplugged)
{
  std::mutex mutex;
  std::condition_variable changed;
  bool is_lost = false;
  VirtualPad pad("virtual pad");
  const auto driver = unwrap(make_driver("gamepad"));
  unwrap(driver->open({ .device = "virtual pad", .notify = [&](const DriverEvent &event) {
                         const std::lock_guard lock(mutex);
                         is_lost = is_lost || event.kind == DriverEvent::Kind::lost;
                         changed.notify_all();
                       } }));
  pad.detach();
  std::unique_lock lock(mutex);
  changed.wait(lock, [&] { return is_lost; });
  lock.unlock();
  fail_if(driver->status().is_there);
  driver->close();
}

CHECK_TEST(test_unknown_name)
{
  const auto driver = unwrap(make_driver("gamepad"));
  const DriverError error = refusal_of(driver->open({ .device = "no such pad" }));
  fail_unless(error.kind == DriverError::Kind::not_found);
  assert_contains(error.text, { "no such pad" });
}

/// SDL is loaded by open() of this driver alone.
CHECK_TEST(test_module_is_not_there)
{
  g_setenv("VISUOTACTILE_MODULES", "/nowhere", TRUE);
  const auto driver = unwrap(make_driver("gamepad"));
  const DriverError error = refusal_of(driver->open({}));
  fail_unless(error.kind == DriverError::Kind::not_found);
  assert_contains(error.text, { "gstreamer1.0-visuotactile-gamepad" });
}

CHECK_MAIN(sdl_gamepads)
