// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The driver of gamepads with gamepads in memory. Nothing here depends on wall time.
#include "tactor/drivers/gamepad_driver.h"

#include "refused.h"
#include "support/contains.h"
#include "support/unwrap.h"

#include <csignal>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;
using Kind = DriverError::Kind;
using EventKind = DriverEvent::Kind;

namespace {

const Gamepad kXbox{ .id = 1, .name = "Xbox Wireless Controller", .path = "/proc/self/comm" };
const Gamepad kOther{ .id = 2, .name = "DualShock 4", .path = "/proc/self/cmdline" };

/// What is plugged in, and what its motors were sent.
struct Room
{
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<Gamepad> plugged{ kXbox };
  int motors = 2;
  bool stops_with_process = true;
  bool takes = true;
  int pipe = -1; ///< gets a byte for each rumble: whether a motor is on
  std::vector<GamepadLevels> sent;
  std::vector<Time> durations;
  int opened = 0;
  int open = 0;
};

class Port final : public GamepadPort
{
public:
  Port(Room &room, const Gamepad &gamepad) : room_(room), gamepad_(gamepad)
  {
  }
  ~Port() override
  {
    const std::lock_guard lock(room_.mutex);
    room_.open--;
    room_.changed.notify_all();
  }
  int motors() const override
  {
    const std::lock_guard lock(room_.mutex);
    return room_.motors;
  }
  bool stops_with_process() const override
  {
    return room_.stops_with_process;
  }
  bool rumble(const GamepadLevels &levels, Time duration) override
  {
    const std::lock_guard lock(room_.mutex);
    room_.sent.push_back(levels);
    room_.durations.push_back(duration);
    if (room_.pipe >= 0) {
      const char is_on = levels != GamepadLevels{} ? '1' : '0';
      (void)!::write(room_.pipe, &is_on, 1);
    }
    room_.changed.notify_all();
    return room_.takes;
  }
  bool is_there() override
  {
    const std::lock_guard lock(room_.mutex);
    return std::ranges::find(room_.plugged, gamepad_) != room_.plugged.end();
  }

private:
  Room &room_;
  const Gamepad gamepad_;
};

class Pads final : public Gamepads
{
public:
  explicit Pads(Room &room) : room_(room)
  {
  }
  std::vector<Gamepad> list() override
  {
    const std::lock_guard lock(room_.mutex);
    return room_.plugged;
  }
  std::unique_ptr<GamepadPort> open(const Gamepad &gamepad) override
  {
    const std::lock_guard lock(room_.mutex);
    room_.opened++;
    room_.open++;
    return std::make_unique<Port>(room_, gamepad);
  }
  void update() override
  {
  }

private:
  Room &room_;
};

struct Rig
{
  Room room;
  std::vector<DriverEvent> events; ///< guarded by the room's mutex
  GamepadDriver driver{ [this] { return std::make_unique<Pads>(room); },
                        { .look_again = 1ms, .update_on = 1ms, .update_idle = 1ms } };

  DriverConfig config(const std::string &device = "", int min_tactors = 1)
  {
    return { .device = device, .min_tactors = min_tactors, .notify = [this](const auto &event) {
              const std::lock_guard lock(room.mutex);
              events.push_back(event);
              room.changed.notify_all();
            } };
  }
  DriverError refusal(const std::string &device = "", int min_tactors = 1)
  {
    DriverError error = refusal_of(driver.open(config(device, min_tactors)));
    fail_unless(driver.tactors() == 0);
    fail_unless(room.open == 0);
    return error;
  }
  void wait_for_levels(const GamepadLevels &levels)
  {
    std::unique_lock lock(room.mutex);
    room.changed.wait(lock, [&] { return !room.sent.empty() && room.sent.back() == levels; });
  }
  void wait_for_event(EventKind kind)
  {
    std::unique_lock lock(room.mutex);
    room.changed.wait(
        lock, [&] { return std::ranges::find(events, kind, &DriverEvent::kind) != events.end(); });
  }
  void wait_for_warning(const std::string &part)
  {
    std::unique_lock lock(room.mutex);
    room.changed.wait(lock, [&] {
      return std::ranges::any_of(events, [&](const DriverEvent &event) {
        return event.kind == EventKind::warning && event.text.find(part) != std::string::npos;
      });
    });
  }
  void plug(std::vector<Gamepad> gamepads)
  {
    const std::lock_guard lock(room.mutex);
    room.plugged = std::move(gamepads);
  }
};

void
assert_has(const std::string &text, const std::string &part)
{
  assert_contains(text, { part.c_str() });
}

} // namespace

/// Whoever writes the levels goes on for ever: the driver's thread ends them.
CHECK_TEST(test_limits)
{
  Rig rig;
  DriverConfig config = rig.config();
  config.limits.max_on_time = 30ms;
  unwrap(rig.driver.open(config));
  const std::jthread writer([&](const std::stop_token &stop) {
    while (!stop.stop_requested()) {
      unwrap(rig.driver.write(std::array{ 3.0 }, 0s));
      std::this_thread::yield();
    }
  });
  rig.wait_for_levels({ 1 });
  rig.wait_for_levels({});
  ck_assert_uint_eq(rig.driver.status().cuts, 1);
}

CHECK_TEST(test_levels)
{
  Rig rig;
  rig.room.motors = 4;
  unwrap(rig.driver.open(rig.config()));
  ck_assert_int_eq(rig.driver.tactors(), 4);
  fail_unless(rig.driver.layout() == (Layout{ .rows = 1, .columns = 2 }));
  rig.wait_for_levels({}); // whatever it did before
  unwrap(rig.driver.write(std::array{ 3.0, 1.5, 0.75, 9.0 }, 0s));
  rig.wait_for_levels({ 1, 0.5, 0.25, 1 });
  unwrap(rig.driver.write(std::array{ 3.0 }, 0s));
  rig.wait_for_levels({ 1, 0, 0, 0 });
  fail_unless(rig.driver.status().is_there);
  fail_if(rig.driver.status().has_watchdog);
  fail_unless(rig.driver.status().motors
              == (std::vector<std::string>{ "left grip, heavy motor", "right grip, light motor",
                                            "left trigger", "right trigger" }));
  rig.driver.close();
  for (std::size_t i = 0; i + 1 < rig.room.durations.size(); i++)
    fail_unless(rig.room.durations[i] == 250ms);
  fail_unless(rig.driver.refresh_interval() < 250ms);
}

/// Tactors beyond max_tactors are left alone.
CHECK_TEST(test_fewer_tactors)
{
  Rig rig;
  DriverConfig config = rig.config();
  config.max_tactors = 1;
  unwrap(rig.driver.open(config));
  fail_unless(rig.driver.layout() == (Layout{ .rows = 1, .columns = 1 }));
  ck_assert_int_eq(static_cast<int>(rig.driver.status().motors.size()), 1);
  unwrap(rig.driver.write(std::array{ 3.0, 3.0 }, 0s));
  rig.wait_for_levels({ 1, 0, 0, 0 });
}

CHECK_TEST(test_zero_on_ways_out)
{
  for (const bool closes : { true, false }) {
    Rig rig;
    auto driver = std::make_unique<GamepadDriver>([&] { return std::make_unique<Pads>(rig.room); },
                                                  GamepadDriver::Settings{});
    unwrap(driver->open(rig.config()));
    unwrap(driver->write(std::array{ 3.0, 3.0 }, 0s));
    rig.wait_for_levels({ 1, 1, 0, 0 });
    if (closes)
      driver->close();
    else
      driver.reset();
    fail_unless(rig.room.sent.back() == GamepadLevels{});
    fail_unless(rig.room.open == 0);
  }
}

/// A child process plays until SIGTERM. Its last rumble is zero.
CHECK_TEST(test_zero_on_signal)
{
  std::array<int, 2> ends{};
  fail_unless(pipe(ends.data()) == 0);
  const pid_t child = fork();
  if (child == 0) {
    (void)std::signal(SIGTERM, SIG_DFL); // check catches it
    Rig rig;
    rig.room.pipe = ends[1];
    unwrap(rig.driver.open(rig.config()));
    unwrap(rig.driver.write(std::array{ 3.0 }, 0s));
    while (true)
      pause();
  }
  close(ends[1]);
  char last = '?';
  while (last != '1')
    ck_assert_int_eq(read(ends[0], &last, 1), 1);
  kill(child, SIGTERM);
  while (read(ends[0], &last, 1) == 1)
    continue;
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  fail_unless(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
  ck_assert_int_eq(last, '0');
}

CHECK_TEST(test_no_gamepad)
{
  Rig rig;
  rig.plug({});
  const DriverError error = rig.refusal();
  fail_unless(error.kind == Kind::not_found);
  assert_has(error.text, "expected a gamepad, found none");
  assert_has(error.text, "plug one in");
}

CHECK_TEST(test_several)
{
  Rig rig;
  rig.plug({ kXbox, kOther });
  unwrap(rig.driver.open(rig.config()));
  assert_has(rig.driver.status().board, kXbox.name);
  assert_has(rig.events.front().text, kOther.path);
  for (const std::string &device : { kOther.name, kOther.path }) {
    unwrap(rig.driver.open(rig.config(device)));
    assert_has(rig.driver.status().board, kOther.name);
  }
  const DriverError error = rig.refusal("Sega");
  fail_unless(error.kind == Kind::not_found);
  for (const std::string &part : { std::string("'Sega'"), kXbox.path, kOther.path })
    assert_has(error.text, part);

  Gamepad taken = kXbox;
  taken.is_taken = true;
  rig.plug({ taken, kOther });
  unwrap(rig.driver.open(rig.config()));
  assert_has(rig.driver.status().board, kOther.name);
  fail_unless(rig.refusal(taken.name).kind == Kind::busy);
}

CHECK_TEST(test_unsuitable)
{
  Rig rig;
  const DriverError few = rig.refusal("", 3);
  fail_unless(few.kind == Kind::settings);
  assert_has(few.text, "mapping needs 3 tactors");
  rig.room.motors = 0;
  fail_unless(rig.refusal().kind == Kind::settings);
  Gamepad locked = kXbox;
  locked.path = "/nowhere/event5";
  rig.plug({ locked });
  const DriverError error = rig.refusal();
  fail_unless(error.kind == Kind::permission);
  assert_has(error.text, "group 'input'");
}

/// The levels are those written meanwhile.
CHECK_TEST(test_lost_and_back)
{
  Rig rig;
  unwrap(rig.driver.open(rig.config()));
  rig.plug({});
  rig.wait_for_event(EventKind::lost);
  fail_if(rig.driver.status().is_there);
  unwrap(rig.driver.write(std::array{ 0.0, 3.0 }, 0s));
  Gamepad back = kXbox;
  back.id = 7;
  back.path = "/dev/input/event9";
  rig.plug({ kOther, back });
  rig.wait_for_event(EventKind::returned);
  rig.wait_for_levels({ 0, 1, 0, 0 });
  fail_unless(rig.driver.status().reconnects == 1);
  assert_has(rig.driver.status().board, back.path);
}

/// A gamepad that takes no levels is lost, not an error of write().
CHECK_TEST(test_takes_nothing)
{
  Rig rig;
  rig.room.takes = false;
  unwrap(rig.driver.open(rig.config()));
  rig.wait_for_event(EventKind::lost);
  unwrap(rig.driver.write(std::array{ 3.0 }, 0s));
}

CHECK_TEST(test_runs_on_if_killed)
{
  Rig rig;
  rig.room.stops_with_process = false;
  unwrap(rig.driver.open(rig.config()));
  rig.wait_for_warning("has no watchdog");
  rig.wait_for_warning("run on if the player is killed");
}

CHECK_MAIN(gamepad_driver)
