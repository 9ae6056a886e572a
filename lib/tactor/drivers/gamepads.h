// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactor/driver_error.h"

#include <tl/expected.hpp>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tactor {

struct Gamepad
{
  int id = 0;       ///< of this connection; a pad that comes back has another one
  std::string name; ///< as in "Xbox Wireless Controller"
  std::string path; ///< as in "/dev/input/event5"; may be empty
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  bool is_bluetooth = false;
  bool is_taken = false; ///< another driver of this process has it
  bool operator==(const Gamepad &) const = default;
};

/// Low-frequency and high-frequency motor, left and right trigger; 0…1.
using GamepadLevels = std::array<double, 4>;

/// An open gamepad. The destructor sets its motors to zero and closes it.
class GamepadPort
{
public:
  virtual ~GamepadPort() = default;

  /// 0: no motors, or they may not be used; 2: none in the triggers; else 4.
  virtual int motors() const = 0;

  /// Whether the motors stop when this process ends in any way, by SIGKILL too.
  virtual bool stops_with_process() const = 0;

  /// Motors are at these levels for `duration`, unless the next call comes before. False if the
  /// gamepad does not take them.
  virtual bool rumble(const GamepadLevels &levels, Time duration) = 0;

  virtual bool is_there() = 0;
};

/// The gamepads of this computer. One thread at a time, as their ports.
class Gamepads
{
public:
  virtual ~Gamepads() = default;

  virtual std::vector<Gamepad> list() = 0;
  /// Null if the gamepad is gone.
  virtual std::unique_ptr<GamepadPort> open(const Gamepad &gamepad) = 0;
  /// Notices gamepads that came or went, and ends durations. To be called several times a second.
  virtual void update() = 0;
};

using MakeGamepads = std::function<tl::expected<std::unique_ptr<Gamepads>, DriverError>()>;

/// The gamepads of SDL, in a module that this call loads, as SDL is large: a process that plays on
/// a board does not load it. The module is searched in $VISUOTACTILE_MODULES, by default where it
/// is installed.
tl::expected<std::unique_ptr<Gamepads>, DriverError> make_sdl_gamepads();

} // namespace tactor
