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
  /// Between two looks at how far the position went.
  static constexpr Time kLook = std::chrono::milliseconds(500);
  /// A film that plays for so long without a position that goes along has none of use.
  static constexpr Time kPatience = std::chrono::seconds(3);

  /// Any number, none for other types.
  static std::optional<double> number(GVariant *value);

  /// Takes a report at a local time while a film plays at a rate; none: nothing, or no number.
  /// Returns the film time.
  std::optional<Time> take(std::optional<double> told, Time now, double rate);
  /// The film time of a notified position, from which no unit is concluded.
  std::optional<Time> meant(std::optional<double> told) const;

  /// The film does not go on from where it was: it leapt, stands, or is another one.
  void leap();

  /// Why there is no position of use; empty: there is one, or it is not clear yet.
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
  int candidate_ = 0; ///< which looked right last
  std::optional<Mark> mark_;
  std::optional<Mark> change_; ///< the last report, and since when
  std::optional<Time> right_;  ///< since when it may go wrong
  std::string fault_;
};

} // namespace follow
