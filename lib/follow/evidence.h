// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "follow/report.h"

#include <cstddef>
#include <deque>

namespace follow {

/// How a player reports its position.
struct Habits
{
  /// Notified reports come at once, but sometimes late, by this at most.
  Time latest = std::chrono::milliseconds(100);
  /// The position is rounded down to multiples of this.
  Time coarseness{ 0 };
  /// The position is not rounded but updated now and then, after `coarseness` of local time at the
  /// latest: the upper bound is a poor one.
  bool lingers = false;
  /// Most that the player's clock gains or loses on ours in a second. Sound cards have 0.2 ms;
  /// players that fit a film's frames to the screen's have more.
  Time skew = std::chrono::microseconds(1000);
  /// Without a report for so long the position is unknown: three times the longest of the last
  /// spans between reports, within these limits.
  Time least_patience = std::chrono::milliseconds(300);
  Time most_patience = std::chrono::seconds(3);
};

/// Computes from the reports of one stretch of film, played without a leap at one rate, where its
/// beginning lies in local time.
///
/// A report that came late or was rounded down has too small a position, never too large a one. So
/// each bounds the truth from below by its arrival, and from above by its query.
/// The least delay counts, not the mean one. Cf. D. Mills, "Internet Time Synchronization: the
/// Network Time Protocol", IEEE Trans. Commun. 39(10), 1991 (clock filter). Bounds widen with age,
/// by Habits::skew. Not thread-safe.
class Evidence
{
public:
  /// From the first report, which has a position.
  Evidence(const Report &first, const Habits &habits);

  /// Distance of the report from the bounds, in film time: > 0 ahead of them, < 0 behind, 0 within.
  Time misfit(const Report &report) const;
  /// Whether a report may belong to this stretch, rounding errors aside.
  bool fits(const Report &report) const;
  void add(const Report &report);

  double rate() const
  {
    return rate_;
  }
  Time position(Time now) const;
  /// Half the width of the bounds, or how densely reports lie at the lower one.
  Time error(Time now) const;

private:
  struct Bounds
  {
    Time at{ 0 };   ///< local time
    double low = 0; ///< ns that the film is ahead of the line through the first report
    double high = 0;
  };
  struct Offset
  {
    double value = 0;
    double error = 0;
  };

  /// Reports that count.
  static constexpr std::size_t kMost = 64;

  Bounds bounds(const Report &report) const;
  double age(const Bounds &bounds, Time now, Time skew) const;
  double low(Time now, std::size_t rank, Time skew) const;
  double high(Time now) const;
  Offset offset() const;

  Habits habits_;
  Time began_;
  Time position_;
  double rate_;
  bool asked_ = false; ///< the player was queried, so that the upper bounds are known
  std::deque<Bounds> bounds_;
  Offset offset_;
};

} // namespace follow
