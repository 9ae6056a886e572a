// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace tactor {

/// How long the serial line to a board takes for levels of tactors. They are sent one after the
/// other, each in a number of bytes that depends on its tactor.
class LineTime
{
public:
  static constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();

  /// A line that takes no time.
  LineTime() = default;
  /// `bytes` has the length of a level of each tactor, 0 for others. `byte` is the time of one.
  LineTime(std::vector<int> bytes, Time byte);

  /// Bytes of an update of these tactors, at most of the `most` longest ones.
  int bytes(std::span<const std::size_t> tactors, std::size_t most = kAny) const;
  /// The time for bytes().
  Time of(std::span<const std::size_t> tactors, std::size_t most = kAny) const;
  /// The time for one level.
  Time of(std::size_t tactor) const;
  /// The time for an update of all tactors.
  Time all() const;

private:
  std::vector<int> bytes_;
  Time byte_{ 0 };
};

} // namespace tactor
