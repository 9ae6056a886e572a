// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <SDL.h>

#include <algorithm>
#include <array>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

#include <gst/check/gstcheck.h>

/// A gamepad that SDL makes. It is there before the driver and SDL's other users.
class VirtualPad
{
public:
  /// `listener`, if any, gets the grips' levels as they come, on SDL's threads.
  explicit VirtualPad(const char *name, bool has_triggers = true,
                      std::function<void(int low, int high)> listener = {})
      : listener_(std::move(listener))
  {
    SDL_SetHint(SDL_HINT_JOYSTICK_HIDAPI, "0");
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    ck_assert_int_eq(SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER), 0);
    SDL_VirtualJoystickDesc description{};
    description.version = SDL_VIRTUAL_JOYSTICK_DESC_VERSION;
    description.type = SDL_JOYSTICK_TYPE_GAMECONTROLLER;
    description.naxes = SDL_CONTROLLER_AXIS_MAX;
    description.nbuttons = SDL_CONTROLLER_BUTTON_MAX;
    description.name = name;
    description.userdata = this;
    description.Rumble = [](void *pad, Uint16 low, Uint16 high) {
      return static_cast<VirtualPad *>(pad)->set(0, low, high);
    };
    if (has_triggers)
      description.RumbleTriggers = [](void *pad, Uint16 left, Uint16 right) {
        return static_cast<VirtualPad *>(pad)->set(2, left, right);
      };
    const int index = SDL_JoystickAttachVirtualEx(&description);
    ck_assert_int_ge(index, 0);
    id_ = SDL_JoystickGetDeviceInstanceID(index);
    learn_success(index);
  }
  ~VirtualPad()
  {
    detach();
    SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
  }

  void detach()
  {
    SDL_LockJoysticks();
    for (int i = 0; i < SDL_NumJoysticks(); i++)
      if (SDL_JoystickGetDeviceInstanceID(i) == id_)
        SDL_JoystickDetachVirtual(i);
    SDL_UnlockJoysticks();
  }

  SDL_JoystickID id() const
  {
    return id_;
  }

  void wait_for(const std::array<int, 4> &levels)
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return levels_ == levels; });
  }
  /// Waits until the grips have had these levels: SDL ends a rumble by itself.
  void wait_for_grips(const std::array<int, 2> &levels)
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return std::ranges::find(history_, levels) != history_.end(); });
  }
  std::array<int, 4> levels()
  {
    const std::lock_guard lock(mutex_);
    return levels_;
  }
  /// Levels of the grips, as they came.
  std::vector<std::array<int, 2>> history()
  {
    const std::lock_guard lock(mutex_);
    return history_;
  }
  /// The next rumble that is not zero takes effect, and fails.
  void fail_once()
  {
    const std::lock_guard lock(mutex_);
    fails_ = true;
  }

private:
  /// Zero, as SDL 2 has it. The one over SDL 3 (sdl2-compat 2.32.74) hands the callback's answer
  /// on, where success is true.
  void learn_success(int index)
  {
    SDL_GameController *controller = SDL_GameControllerOpen(index);
    if (SDL_GameControllerRumble(controller, 1, 1, 0) != 0)
      success_ = 1;
    SDL_GameControllerRumble(controller, 2, 2, 0);
    SDL_GameControllerRumble(controller, 0, 0, 0);
    ck_assert_int_eq(SDL_GameControllerRumble(controller, 1, 1, 0), 0);
    SDL_GameControllerRumble(controller, 0, 0, 0);
    SDL_GameControllerClose(controller);
    const std::lock_guard lock(mutex_);
    history_.clear();
  }

  int set(std::size_t first, int a, int b)
  {
    const std::lock_guard lock(mutex_);
    levels_[first] = a;
    levels_[first + 1] = b;
    if (first == 0)
      history_.push_back({ a, b });
    if (first == 0 && listener_)
      listener_(a, b);
    changed_.notify_all();
    return (a > 1 || b > 1) && std::exchange(fails_, false) ? 1 - success_ : success_;
  }

  const std::function<void(int, int)> listener_;
  SDL_JoystickID id_ = -1;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::array<int, 4> levels_{};
  std::vector<std::array<int, 2>> history_;
  int success_ = 0;
  bool fails_ = false;
};
