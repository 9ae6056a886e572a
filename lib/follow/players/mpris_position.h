// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "follow/report.h"

#include <glib.h>

#include <optional>
#include <string>

namespace follow {

/// Converts the reported position of a player. MPRIS prescribes microseconds in a 64-bit integer.
/// Some players report other numbers, other units, or nothing of use. The right unit is the one by
/// which the position advances as fast as the film; it changes only if that holds twice in a row,
/// as a leap may look like it once. Reads no clock; not thread-safe.
class MprisPosition
{
public:
  /// Time between two comparisons of the position's advance.
  static constexpr Time kLook = std::chrono::milliseconds(500);
  /// After so long without a position that advances with the film, the position is unusable.
  static constexpr Time kPatience = std::chrono::seconds(3);

  /// Any number, none for other types.
  static std::optional<double> number(GVariant *value);

  /// Takes a report at a local time while a film plays at a rate; none: nothing, or no number.
  /// Returns the film time.
  std::optional<Time> take(std::optional<double> told, Time now, double rate);
  /// The film time of a notified position, from which no unit is concluded.
  std::optional<Time> meant(std::optional<double> told) const;

  /// The film does not continue from its last position: it has leapt, stands, or is another one.
  void leap();

  /// The reason for which the position is unusable; empty: it is usable, or not decided yet.
  const std::string &fault() const
  {
    return fault_;
  }
  /// "microseconds", as it should be, "milliseconds" or "nanoseconds"
  const char *unit() const;

private:
  struct Mark
  {
    Time at{ 0 };
    double told = 0;
  };
  void judge(double told, Time now, double rate);

  int unit_ = 0;      ///< index of kUnits
  int candidate_ = 0; ///< the unit that fitted last
  std::optional<Mark> mark_;
  std::optional<Mark> change_; ///< the last report, and since when
  std::optional<Time> right_;  ///< since when it may go wrong
  std::string fault_;
};

} // namespace follow
