// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

namespace tactor {

/// Whether a program has the kernel's serial line of a device (/dev/ttyACM0) open.
struct LineUse
{
  enum class Kind
  {
    free,
    perhaps, ///< a program of another user has a line of this kind open, this one or another
    certain,
  };

  Kind kind = Kind::free;
  std::string by{}; ///< "cat (process 1234) has ttyUSB0 open"; empty if free

  bool operator==(const LineUse &) const = default;
};

} // namespace tactor
