// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <optional>

namespace tactor {

/// Nobody is startled by motors that come on at full power as the play begins, goes on or jumps:
/// the first vibration after arm() is held below a ceiling that rises to full scale. Not
/// thread-safe: its owner guards it.
class SoftStart
{
public:
  /// How often the ceiling rises where the line carries that: nine motors take 5 ms on it, 64 take
  /// 60 ms.
  static constexpr Time kStep = std::chrono::milliseconds(20);

  /// How long the ceiling takes from nothing to full scale; 0: there is none.
  void set_length(Time length);

  /// The motors are at zero; the next vibration is a soft start.
  void arm();

  /// The motors vibrate at `now`, and the line takes `update` to carry that: a step that begins now
  /// lasts max(kStep, update), and so do those after it until this says otherwise. True if a soft
  /// start begins. One that is under way begins again if time goes back.
  bool vibrate(Time now, Time update = Time(0));

  /// What a motor may get at `now`, a share of full scale: the end of the present step, counted
  /// from the first one's begin, / length, 1 at most.
  double ceiling(Time now) const;

  /// When the ceiling rises next; none: it is at full scale, or nothing has vibrated yet.
  std::optional<Time> next_step(Time now) const;

private:
  Time step_end(Time now) const;

  Time length_{ 0 };
  bool armed_ = true;
  std::optional<Time> begin_;
  Time step_begin_{ 0 }; ///< of the last step that vibrate() has seen
  Time step_ = kStep;    ///< how long it lasts
};

} // namespace tactor
