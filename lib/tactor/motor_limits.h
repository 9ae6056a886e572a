// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactor/line_time.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

namespace tactor {

/// What motors, and the skin on them, are spared: coin motors heat up, skin adapts, and users of
/// the paper's chair asked for shorter cues (Section 6). 0 switches a limit off.
struct MotorLimits
{
  Time max_on_time = std::chrono::seconds(2); ///< one tactor without a break
  double max_duty = 0.4; ///< one tactor, share of any MotorUse::kDutyWindow; from 1 on: off
  int max_active = 4;    ///< tactors at once

  /// How many tactors may change at once: as many begin as end.
  std::size_t most_changes() const
  {
    return max_active > 0 ? 2 * static_cast<std::size_t>(max_active) : LineTime::kAny;
  }
  bool operator==(const MotorLimits &) const = default;
};

/// How often each limit acted.
struct LimitCounters
{
  std::uint64_t on_time = 0; ///< cues that max_on_time ended
  std::uint64_t duty = 0;    ///< cues that max_duty ended, or did not let begin
  std::uint64_t number = 0;  ///< cues that stronger ones ended, or did not let begin
};

/// When one motor was told to be on, and how long it may be. All times are those of commands
/// (Command::due).
///
/// A cue is what is felt as one: stretches with breaks below kShortestRest. Accounting is exact for
/// kMostStretches stretches in kDutyWindow; with more the oldest are joined, and what was between
/// them counts as on. Not thread-safe: its planner's thread.
class MotorUse
{
public:
  static constexpr Time kDutyWindow = std::chrono::seconds(60);
  /// A motor falls in 30 ms and rises in up to 180 ms: a shorter break is no rest.
  static constexpr Time kShortestRest = std::chrono::milliseconds(100);
  static constexpr std::size_t kMostStretches = 256;

  enum class Limit
  {
    none,
    on_time,
    duty,
  };
  struct End
  {
    Time time = Time::max();
    Limit limit = Limit::none; ///< the one that asks for it
  };

  /// When a stretch that begins (or, of a motor that is on, began) at `begin` has to end, ≥
  /// `begin`.
  End latest_end(Time begin, const MotorLimits &limits) const;

  bool is_on() const;

  /// When the present stretch began; of a motor that is on.
  Time on_since() const;

  /// From when on the motor is off: Time::min() if it never was on, Time::max() while it is.
  Time off_since() const;

  /// The earliest time that a stretch may begin.
  Time ready_at() const;

  /// A stretch begins, not before ready_at().
  void begin(Time time);

  /// The stretch ends; `limited` if a limit made it end, after which there is a rest of
  /// kShortestRest.
  void end(Time time, bool limited);

  /// Nothing that was told for `time` or later came to pass: the motor was off from then on.
  void forget_from(Time time);

  /// All that was is so much further back.
  void age(Time by);

private:
  struct Stretch
  {
    Time cue; ///< when the cue began that it belongs to
    Time begin;
    Time end;
  };

  Time cue_begin(Time begin) const;
  Time duty_end(Time begin, Time allowed) const;

  std::deque<Stretch> past_; ///< in order, apart from each other, the last kDutyWindow at least
  std::optional<Time> on_since_;
  Time ready_at_ = Time::min();
};

} // namespace tactor
