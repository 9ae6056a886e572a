// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The families of devices, each as its own side sees it.
#pragma once

#include "nanoseconds.h"
#include "tactor/motor_model.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

using tactor::Time;

/// The volts of a motor at level 1.
inline constexpr double kVolts = 3;

/// A device, and all that its first motor did.
class Device
{
public:
  struct Change
  {
    Time at; ///< steady time
    double level;
  };

  virtual ~Device() = default;

  /// All so far.
  virtual std::vector<Change> changes() = 0;
  /// Waits for the first change from `begin` on to nearly full strength, or to zero.
  virtual Change wait_for(Time begin, bool on) = 0;
  /// How many messages waited behind each one that a server got.
  virtual std::vector<std::size_t> waiting()
  {
    return {};
  }

  std::string sink; ///< an element with properties that find this device; it has no name
  std::string own;  ///< name of the GstBaseSink within it, if it is a bin
};

struct Family
{
  std::string name;
  bool is_listed;       ///< by visuotactile-play --list-devices
  bool has_own_process; ///< it outlives the process that plays
  bool answers;         ///< each message, so that it can be slow
  std::function<tactor::MotorModel()> motor;
  /// `slow`: takes 200 ms for a message.
  std::function<std::unique_ptr<Device>(bool slow)> make;
};

std::vector<Family> families();
