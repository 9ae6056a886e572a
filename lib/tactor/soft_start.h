// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/time.h"

#include <optional>

namespace tactor {

/// Nobody is startled by motors that come on at full power as the play begins, goes on or jumps: the first vibration after
/// arm() is held below a ceiling that rises to full scale. Not thread-safe: its owner guards it.
class SoftStart
{
public:
  /// How often the ceiling rises: nine motors take 5 ms on the wire.
  static constexpr Time kStep = std::chrono::milliseconds(20);

  /// How long the ceiling takes from nothing to full scale; 0: there is none.
  void set_length(Time length);

  /// The motors are at zero; the next vibration is a soft start.
  void arm();

  /// The motors vibrate at `now`. True if a soft start begins. One that is under way begins again if time goes back.
  bool vibrate(Time now);

  /// What a motor may get at `now`, a share of full scale: (n + 1) · kStep / length in the n-th step, 1 at most.
  double ceiling(Time now) const;

  /// When the ceiling rises next; none: it is at full scale, or nothing has vibrated yet.
  std::optional<Time> next_step(Time now) const;

private:
  Time length_{ 0 };
  bool armed_ = true;
  std::optional<Time> begin_;
};

} // namespace tactor
