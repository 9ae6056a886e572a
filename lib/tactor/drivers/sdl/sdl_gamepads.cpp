// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The module that tactor::make_sdl_gamepads() loads.
#include "tactor/drivers/gamepads.h"
#include "tactor/priority_mutex.h"

#include <SDL.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>
#include <string_view>

namespace {

using tactor::Gamepad;
using tactor::GamepadLevels;
using tactor::Time;

/// SDL counts its users, and this its open gamepads, for all drivers of the process.
tactor::PriorityMutex sdl_mutex;
std::set<SDL_JoystickID> taken; ///< guarded by it

Uint16
strength(double level)
{
  return static_cast<Uint16>(std::lround(std::clamp(level, 0.0, 1.0) * 65535));
}

std::string
text(const char *string)
{
  return string != nullptr ? string : "";
}

class SdlPort final : public tactor::GamepadPort
{
public:
  SdlPort(SDL_GameController *controller, SDL_JoystickID id) : controller_(controller), id_(id)
  {
  }

  ~SdlPort() override
  {
    const std::lock_guard lock(sdl_mutex);
    send({}, 0);
    SDL_GameControllerClose(controller_);
    taken.erase(id_);
  }

  int motors() const override
  {
    const std::lock_guard lock(sdl_mutex);
    if (!SDL_GameControllerHasRumble(controller_))
      return 0;
    return has_triggers() ? 4 : 2;
  }

  bool stops_with_process() const override
  {
    // The kernel ends the effects of a closed event device. A hidraw device keeps its last report.
    const std::lock_guard lock(sdl_mutex);
    return std::string_view(text(SDL_GameControllerPath(controller_))).starts_with("/dev/input/");
  }

  bool rumble(const GamepadLevels &levels, Time duration) override
  {
    const std::lock_guard lock(sdl_mutex);
    return send(levels,
                static_cast<Uint32>(
                    std::chrono::duration_cast<std::chrono::milliseconds>(duration).count()));
  }

  bool is_there() override
  {
    const std::lock_guard lock(sdl_mutex);
    return SDL_GameControllerGetAttached(controller_);
  }

private:
  bool has_triggers() const
  {
    return SDL_GameControllerHasRumbleTriggers(controller_);
  }

  /// SDL does not send a zero to a pad that it believes to be at zero: one that was just opened and
  /// may run from before, and in SDL 3 one whose last rumble failed, which may have begun all the
  /// same. So a level that nobody feels goes before such a zero.
  bool send(const GamepadLevels &levels, Uint32 ms)
  {
    if (!is_known_ && levels == GamepadLevels{})
      set(1, 1, 1, 1, ms);
    is_known_ = set(strength(levels[0]), strength(levels[1]), strength(levels[2]),
                    strength(levels[3]), ms);
    return is_known_;
  }

  bool set(Uint16 low, Uint16 high, Uint16 left, Uint16 right, Uint32 ms)
  {
    const bool grips = SDL_GameControllerRumble(controller_, low, high, ms) == 0;
    const bool triggers
        = !has_triggers() || SDL_GameControllerRumbleTriggers(controller_, left, right, ms) == 0;
    return grips && triggers;
  }

  SDL_GameController *const controller_;
  const SDL_JoystickID id_;
  bool is_known_ = false; ///< SDL's levels are those of the pad
};

class SdlGamepads final : public tactor::Gamepads
{
public:
  ~SdlGamepads() override
  {
    const std::lock_guard lock(sdl_mutex);
    if (is_open_)
      SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
    SDL_TLSCleanup(); // SDL does so for its own threads only
  }

  bool open_sdl(std::string &why)
  {
    const std::lock_guard lock(sdl_mutex);
    // Signals belong to the application and to TerminationGuard.
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");
    // Uses the kernel's drivers. SDL's own drivers detach them or switch the gamepad's reports,
    // which takes its buttons from a game. The environment overrides this.
    SDL_SetHintWithPriority(SDL_HINT_JOYSTICK_HIDAPI, "0", SDL_HINT_DEFAULT);
    const bool is_first = SDL_WasInit(SDL_INIT_JOYSTICK) == 0;
    if (SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER) != 0) {
      why = SDL_GetError();
      return false;
    }
    is_open_ = true;
    // Nobody reads events here. An application that uses SDL itself does.
    if (is_first) {
      SDL_GameControllerEventState(SDL_IGNORE);
      SDL_JoystickEventState(SDL_IGNORE);
    }
    return true;
  }

  std::vector<Gamepad> list() override
  {
    const std::lock_guard lock(sdl_mutex);
    SDL_JoystickUpdate();
    SDL_LockJoysticks(); // indices stay
    std::vector<Gamepad> all;
    for (int i = 0; i < SDL_NumJoysticks(); i++) {
      if (!SDL_IsGameController(i))
        continue;
      const SDL_JoystickGUID guid = SDL_JoystickGetDeviceGUID(i);
      const SDL_JoystickID id = SDL_JoystickGetDeviceInstanceID(i);
      constexpr int kBluetooth = 0x05; // BUS_BLUETOOTH of linux/input.h
      all.push_back({ .id = id,
                      .name = text(SDL_GameControllerNameForIndex(i)),
                      .path = text(SDL_GameControllerPathForIndex(i)),
                      .vendor = SDL_JoystickGetDeviceVendor(i),
                      .product = SDL_JoystickGetDeviceProduct(i),
                      .is_bluetooth = guid.data[0] == kBluetooth && guid.data[1] == 0,
                      .is_taken = taken.contains(id) });
    }
    SDL_UnlockJoysticks();
    return all;
  }

  std::unique_ptr<tactor::GamepadPort> open(const Gamepad &gamepad) override
  {
    const std::lock_guard lock(sdl_mutex);
    SDL_LockJoysticks();
    SDL_GameController *controller = nullptr;
    for (int i = 0; i < SDL_NumJoysticks() && controller == nullptr; i++)
      if (SDL_JoystickGetDeviceInstanceID(i) == gamepad.id)
        controller = SDL_GameControllerOpen(i);
    SDL_UnlockJoysticks();
    if (controller == nullptr || !taken.insert(gamepad.id).second) {
      SDL_GameControllerClose(controller);
      return nullptr;
    }
    return std::make_unique<SdlPort>(controller, gamepad.id);
  }

  void update() override
  {
    const std::lock_guard lock(sdl_mutex);
    SDL_JoystickUpdate();
  }

private:
  bool is_open_ = false;
};

} // namespace

/// Null if SDL does not start; `why` is its error.
extern "C" __attribute__((visibility("default"))) tactor::Gamepads *
visuotactile_make_gamepads(std::string &why)
{
  auto gamepads = std::make_unique<SdlGamepads>();
  return gamepads->open_sdl(why) ? gamepads.release() : nullptr;
}
