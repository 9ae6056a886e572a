// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace tactor {

/// What a serial line to a board carries: levels of tactors, one after the other, each of so many
/// bytes. A value.
class LineTime
{
public:
  static constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();

  /// A line on which nothing takes time.
  LineTime() = default;
  /// `bytes` of a level of each tactor, others take none; `byte` is how long one takes.
  LineTime(std::vector<int> bytes, Time byte);

  /// Of an update of these tactors, or of so many of them, those that take most.
  int bytes(std::span<const std::size_t> tactors, std::size_t most = kAny) const;
  /// How long that takes.
  Time of(std::span<const std::size_t> tactors, std::size_t most = kAny) const;
  /// How long one level takes.
  Time of(std::size_t tactor) const;
  /// How long an update of all tactors takes.
  Time all() const;

private:
  std::vector<int> bytes_;
  Time byte_{ 0 };
};

} // namespace tactor
