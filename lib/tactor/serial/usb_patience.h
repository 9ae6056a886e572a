// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <chrono>

namespace tactor {

/// Timeouts and intervals.
struct UsbPatience
{
  /// For each request of the setup; there are at most 6.
  std::chrono::milliseconds request{ 1000 };
  /// For a write. The longest one takes 89 ms on the line.
  std::chrono::milliseconds write{ 1000 };
  /// Time between two lists of the plugged devices, while they are watched. With udevd, changes are
  /// reported at once.
  std::chrono::milliseconds look{ 1000 };
};

} // namespace tactor
