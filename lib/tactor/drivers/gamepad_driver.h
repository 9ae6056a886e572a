// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/drivers/gamepads.h"
#include "tactor/drivers/rumble.h"
#include "tactor/drivers/threaded_driver.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tactor {

/// A gamepad's motors: tactor 0 has low frequencies (left grip), 1 high ones (right grip), 2 and 3
/// are in the left and right trigger where they are to be had.
///
/// DriverConfig::device is the gamepad's path or name. Without it the first one with motors is
/// taken that no other driver of the process has. A lost gamepad is searched for every
/// `look_again`, by its name and maker.
///
/// Each rumble has a duration (RumbleTimes), after which SDL ends it, as long as the process runs:
/// the gamepad itself has no watchdog. A thread of the driver has the
/// gamepads; write() hands it the levels and never waits. If a signal or exit() ends the process,
/// the motors are stopped first: see TerminationGuard.
class GamepadDriver : public ThreadedDriver
{
public:
  struct Settings
  {
    RumbleTimes times{};
    Time look_again = std::chrono::seconds(1);
    /// Between calls of Gamepads::update() while a motor is on, and while none is.
    Time update_on = std::chrono::milliseconds(20);
    Time update_idle = std::chrono::milliseconds(250);
  };

  GamepadDriver();
  GamepadDriver(MakeGamepads make_gamepads, Settings settings);
  ~GamepadDriver() override;

  Layout layout() const override;
  double resolution() const override;
  Time transport_latency() const override;
  Time refresh_interval() const override;

private:
  // On the driver's thread. Those with a lock release it while they use gamepads.
  void run(Lock &lock) override;
  tl::expected<std::unique_ptr<GamepadPort>, DriverError> connect(Lock &lock, Gamepads &gamepads);
  std::unique_ptr<GamepadPort> connect_again(Lock &lock, Gamepads &gamepads);
  void play(Lock &lock, Gamepads &gamepads, GamepadPort &port);
  void release(Lock &lock, std::unique_ptr<GamepadPort> port);

  void reset() override;

  const MakeGamepads make_gamepads_;
  const Settings settings_;

  // Guarded by the mutex
  Gamepad gamepad_;              ///< the one that was taken last
  std::optional<Rumble> rumble_; ///< while a gamepad is open
};

} // namespace tactor
