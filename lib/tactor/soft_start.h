// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <optional>

namespace tactor {

/// Keeps the first vibration after a start, a pause or a seek from startling: after arm() it stays
/// below a ceiling that rises to full scale in steps. Not thread-safe.
class SoftStart
{
public:
  /// Shortest step of the ceiling. The line takes 5 ms for nine motors and 60 ms for 64.
  static constexpr Time kStep = std::chrono::milliseconds(20);

  /// Time of the ceiling from zero to full scale; 0: no ceiling.
  void set_length(Time length);

  /// The motors are at zero; the next vibration is a soft start.
  void arm();

  /// The motors vibrate at `now`, and the line takes `update` for their levels: a step that begins
  /// now lasts max(kStep, update), as do those after it until the next call. True if a soft start
  /// begins. A soft start restarts if time goes back.
  bool vibrate(Time now, Time update = Time(0));

  /// Ceiling at `now` as a share of full scale: (end of the present step − begin of the soft start)
  /// / length, 1 at most.
  double ceiling(Time now) const;

  /// When the ceiling rises next; none at full scale or before the first vibration.
  std::optional<Time> next_step(Time now) const;

private:
  Time step_end(Time now) const;

  Time length_{ 0 };
  bool armed_ = true;
  std::optional<Time> begin_;
  Time step_begin_{ 0 }; ///< of the last step that vibrate() has seen
  Time step_ = kStep;    ///< its length
};

} // namespace tactor
