// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/gamepad_driver.h"

#include "tactor/realtime/realtime_thread.h"
#include "tactor/unlocked.h"

#include <unistd.h>

#include <algorithm>
#include <thread>
#include <utility>

namespace tactor {

namespace {

std::string
describe(const Gamepad &gamepad)
{
  return gamepad.name + (gamepad.path.empty() ? "" : " (" + gamepad.path + ")");
}

std::string
describe(const std::vector<Gamepad> &gamepads)
{
  std::string text;
  for (const Gamepad &gamepad : gamepads)
    text += (text.empty() ? "" : ", ") + describe(gamepad);
  return text;
}

/// As the user sees them.
std::vector<std::string>
names_of_motors(int motors)
{
  std::vector<std::string> names{ "left grip, heavy motor", "right grip, light motor",
                                  "left trigger", "right trigger" };
  names.resize(static_cast<std::size_t>(motors));
  return names;
}

bool
is_wanted(const Gamepad &gamepad, const std::string &device)
{
  return device.empty() || gamepad.path == device || gamepad.name == device;
}

DriverError
refusal_of_none(const std::string &device, const std::vector<Gamepad> &all)
{
  if (all.empty())
    return { DriverError::Kind::not_found,
             "expected a gamepad" + (device.empty() ? "" : " '" + device + "'")
                 + ", found none; plug one in or pair it, and see docs/hardware/gamepad.md" };
  return { DriverError::Kind::not_found, "expected a gamepad whose name or path is '" + device
                                             + "', found " + describe(all)
                                             + "; set device to one of these" };
}

/// Why a gamepad without usable motors is refused.
DriverError
refusal_of_motors(const Gamepad &gamepad)
{
  if (!gamepad.path.empty() && access(gamepad.path.c_str(), W_OK) != 0)
    return { DriverError::Kind::permission,
             describe(gamepad)
                 + ": expected a device that you may write, and you may not; play at "
                   "the computer itself, or join the group 'input'" };
  return { DriverError::Kind::settings,
           describe(gamepad) + ": expected rumble motors, found none; take another gamepad" };
}

} // namespace

GamepadDriver::GamepadDriver() : GamepadDriver(make_sdl_gamepads, Settings{})
{
}

GamepadDriver::GamepadDriver(MakeGamepads make_gamepads, Settings settings)
    : make_gamepads_(std::move(make_gamepads)), settings_(settings)
{
}

GamepadDriver::~GamepadDriver()
{
  GamepadDriver::close();
}

/* ---- the caller's side ---- */

void
GamepadDriver::reset()
{
}

/// The grips. Triggers are named by a mapping.
Layout
GamepadDriver::layout() const
{
  return { .rows = 1, .columns = std::min(tactors(), 2) };
}

double
GamepadDriver::resolution() const
{
  const std::lock_guard lock(mutex_);
  return is_open_ ? config_.full_scale_volts / 65535 : 0;
}

/// Unknown: SDL does not report it, and gamepads do not answer.
Time
GamepadDriver::transport_latency() const
{
  return Time(0);
}

Time
GamepadDriver::refresh_interval() const
{
  return settings_.times.refresh;
}

/* ---- the driver's thread ---- */

void
GamepadDriver::run(Lock &lock)
{
  std::unique_ptr<Gamepads> gamepads;
  std::unique_ptr<GamepadPort> port;
  const tl::expected<void, DriverError> connected
      = without(lock, make_gamepads_)
            .and_then([&](std::unique_ptr<Gamepads> &&made) {
              gamepads = std::move(made);
              return connect(lock, *gamepads);
            })
            .map([&](std::unique_ptr<GamepadPort> &&first) { port = std::move(first); });
  if (connected)
    opened();
  else
    refuse(connected.error());

  while (port) {
    play(lock, *gamepads, *port);
    release(lock, std::exchange(port, nullptr));
    if (quit_)
      break;
    status_.is_there = false;
    tell(lock, DriverEvent::Kind::lost,
         describe(gamepad_) + ": it was unplugged, switched off, or its battery is empty");
    while (!quit_ && !port)
      port = connect_again(lock, *gamepads);
    if (!port)
      break;
    status_.reconnects++;
    tell(lock, DriverEvent::Kind::returned, status_.board + " is back");
  }
  {
    const Unlocked unlocked(lock);
    port.reset();
    gamepads.reset();
  }
}

/// Opens the first gamepad that is wanted and has motors.
tl::expected<std::unique_ptr<GamepadPort>, DriverError>
GamepadDriver::connect(Lock &lock, Gamepads &gamepads)
{
  std::vector<Gamepad> all = without(lock, [&] { return gamepads.list(); });
  DriverError refusal = refusal_of_none(config_.device, all);
  for (const Gamepad &gamepad : all) {
    if (!is_wanted(gamepad, config_.device))
      continue;
    if (quit_)
      return tl::unexpected(
          DriverError{ DriverError::Kind::failed, "the opening of the gamepad was stopped" });
    if (gamepad.is_taken) {
      refusal = { DriverError::Kind::busy,
                  describe(gamepad)
                      + ": expected a free gamepad, and another tactorsink of this program plays "
                        "on it; plug in another" };
      continue;
    }
    std::unique_ptr<GamepadPort> port;
    int motors = 0;
    bool stops_with_process = false;
    {
      const Unlocked unlocked(lock);
      port = gamepads.open(gamepad);
      motors = port ? port->motors() : 0;
      stops_with_process = port && port->stops_with_process();
    }
    const int tactors = std::min(motors, config_.max_tactors);
    if (motors == 0) {
      refusal = refusal_of_motors(gamepad);
    } else if (tactors < config_.min_tactors) {
      refusal = { DriverError::Kind::settings,
                  describe(gamepad) + ": mapping needs " + std::to_string(config_.min_tactors)
                      + " tactors, and it has " + std::to_string(tactors)
                      + "; set mapping to tactors below that" };
    } else {
      tactors_ = tactors;
      gamepad_ = gamepad;
      status_.board = describe(gamepad);
      status_.firmware = gamepad.is_bluetooth ? "gamepad by Bluetooth" : "gamepad";
      status_.motors = names_of_motors(tactors);
      status_.has_watchdog = false;
      status_.is_there = true;
      rumble_.emplace(shortest_interval(gamepad), settings_.times);
      use_account(gamepad.name + " " + gamepad.path);
      std::erase(all, gamepad_); // not by `gamepad`, which is in it
      tell(lock, DriverEvent::Kind::opened,
           describe(gamepad_) + ": " + std::to_string(tactors) + " motors"
               + (all.empty()
                      ? ""
                      : "; another is chosen by device=PATH or device=NAME: " + describe(all)));
      // Effects of the kernel last for SDL_MAX_RUMBLE_DURATION_MS; SDL itself ends them earlier.
      tell(lock, DriverEvent::Kind::warning,
           describe(gamepad_)
               + " has no watchdog: motors run on for up to 65 s if this computer hangs or the "
                 "player stands still");
      if (!stops_with_process)
        tell(lock, DriverEvent::Kind::warning,
             describe(gamepad_)
                 + ": its motors may run on if the player is killed, as SDL drives it without the "
                   "kernel; unset SDL_JOYSTICK_HIDAPI, or switch the gamepad off then");
      return port;
    }
    const Unlocked unlocked(lock);
    port.reset();
  }
  return tl::unexpected(refusal);
}

/// Waits and searches for the lost gamepad. Null if it is missing or not usable.
std::unique_ptr<GamepadPort>
GamepadDriver::connect_again(Lock &lock, Gamepads &gamepads)
{
  changed_.wait_for(lock, settings_.look_again, [this] { return quit_; });
  if (quit_)
    return nullptr;
  std::unique_ptr<GamepadPort> port;
  Gamepad found = gamepad_;
  {
    const Unlocked unlocked(lock);
    const auto is_it = [lost = found](const Gamepad &gamepad) {
      return !gamepad.is_taken && gamepad.name == lost.name && gamepad.vendor == lost.vendor
             && gamepad.product == lost.product;
    };
    const std::vector<Gamepad> all = gamepads.list();
    const auto again = std::ranges::find_if(all, is_it);
    if (again != all.end()) {
      found = *again;
      port = gamepads.open(found);
    }
    if (port && port->motors() < tactors_)
      port.reset();
  }
  if (!port)
    return nullptr;
  gamepad_ = found;
  status_.board = describe(found);
  status_.is_there = true;
  rumble_.emplace(shortest_interval(found), settings_.times);
  return port;
}

/// Sends levels until the gamepad is gone or the driver quits.
void
GamepadDriver::play(Lock &lock, Gamepads &gamepads, GamepadPort &port)
{
  RealtimeThread realtime(config_.realtime);
  Time next_update = steady_now();
  while (!quit_) {
    realtime.turn();
    const Time now = steady_now();
    if (has_new_levels(now)) {
      const std::vector<double> wanted = levels(now);
      GamepadLevels set{};
      std::copy_n(wanted.begin(), std::min(wanted.size(), set.size()), set.begin());
      rumble_->set(set);
    }
    if (const std::optional<GamepadLevels> levels = rumble_->next(now)) {
      const Unlocked unlocked(lock);
      if (!port.rumble(*levels, settings_.times.duration))
        return;
    } else if (now >= next_update) {
      const Unlocked unlocked(lock);
      gamepads.update();
      if (!port.is_there())
        return;
    } else {
      const Time until = std::min({ next_update, rumble_->deadline().value_or(Time::max()),
                                    levels_end().value_or(Time::max()) });
      changed_.wait_until(lock, std::chrono::steady_clock::time_point(until));
      continue;
    }
    next_update = now + (rumble_->is_on() ? settings_.update_on : settings_.update_idle);
  }
}

/// Motors to zero and the gamepad closed.
void
GamepadDriver::release(Lock &lock, std::unique_ptr<GamepadPort> port)
{
  stand();
  rumble_->set({});
  const std::optional<Time> due = rumble_->deadline();
  rumble_.reset();
  const Unlocked unlocked(lock);
  if (due) {
    // A zero that comes too soon after the last levels may be lost on its way.
    std::this_thread::sleep_until(std::chrono::steady_clock::time_point(*due));
    port->rumble({}, Time(0));
  }
  port.reset();
}

} // namespace tactor
