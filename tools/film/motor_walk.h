// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

#include <functional>
#include <string>
#include <vector>

/// Motors to feel one after the other, and the tactile map in which each has a cell.
struct MotorWalk
{
  std::vector<std::string> names; ///< of the motor of cell 0…
  unsigned rows = 0;
  unsigned columns = 0;
  std::string mapping; ///< the sink's, or empty: as it is set
};

/// The cells of a grid: "row 1, column 2".
MotorWalk walk_of_grid(unsigned rows, unsigned columns);

/// A cell for each of these, whatever the device's layout. Throws std::runtime_error for more than
/// 4096.
MotorWalk walk_of_motors(const std::vector<std::string> &names);

/// The motors of a device that knows them, which is opened for that; of another one, those of the
/// grid. Throws std::runtime_error.
MotorWalk walk_of_device(const std::string &driver, const std::string &device, unsigned rows,
                         unsigned columns);

/// The motors but for all names except that of number `only`, from 1. Throws std::runtime_error if
/// there is none.
void keep_motor(MotorWalk &motors, int only);

/// Drives each motor that has a name by `sink`, which is in no bin, for half a second. Calls `show`
/// with its name when that begins, and `warn` with warnings. Where the motors are simulated that is
/// shown first, and is an error unless the sink's driver is the simulator. Throws
/// std::runtime_error.
void walk(GstElement *sink, const MotorWalk &motors,
          const std::function<void(const std::string &)> &show,
          const std::function<void(const std::string &)> &warn);
