// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"
#include "tactor/line_time.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

namespace tactor {

/// Limits that spare motors and skin: coin motors heat up, skin adapts, and users of the paper's
/// chair wanted shorter cues (Section 6). 0 switches a limit off.
struct MotorLimits
{
  Time max_on_time = std::chrono::seconds(2); ///< of one tactor without a break
  double max_duty = 0.4; ///< of one tactor, share of any MotorUse::kDutyWindow; ≥ 1: off
  int max_active = 4;    ///< tactors at once

  /// Tactors that may change at once: max_active begin and max_active end.
  std::size_t most_changes() const
  {
    return max_active > 0 ? 2 * static_cast<std::size_t>(max_active) : LineTime::kAny;
  }
  bool operator==(const MotorLimits &) const = default;

  static MotorLimits none()
  {
    return { .max_on_time = Time(0), .max_duty = 0, .max_active = 0 };
  }
};

struct LimitCounters
{
  std::uint64_t on_time = 0; ///< cues that max_on_time ended
  std::uint64_t duty = 0;    ///< cues that max_duty ended or prevented
  std::uint64_t number = 0;  ///< cues that max_active ended or prevented
};

/// The account of one motor's on-times, and how long it may be on. All times are due times of
/// commands.
///
/// A cue is felt as one: stretches with breaks below the shortest rest. The account is exact for
/// kMostStretches stretches in kDutyWindow. With more, the oldest are joined, and the time between
/// them counts as on. Not thread-safe.
class MotorUse
{
public:
  static constexpr Time kDutyWindow = std::chrono::seconds(60);
  /// A motor falls in 30 ms and rises in up to 180 ms, so that a shorter break is not felt.
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
    Limit limit = Limit::none; ///< the one that sets it
  };

  /// Breaks shorter than `shortest_rest` do not end a cue.
  explicit MotorUse(Time shortest_rest = kShortestRest) : shortest_rest_(shortest_rest)
  {
  }
  /// The same on-times; what follows is by another shortest rest.
  MotorUse with_rest(Time shortest_rest) const
  {
    MotorUse use = *this;
    use.shortest_rest_ = shortest_rest;
    return use;
  }

  /// When a stretch from `begin` on has to end, ≥ `begin`. For a motor that is on, `begin` is
  /// on_since().
  End latest_end(Time begin, const MotorLimits &limits) const;

  bool is_on() const;

  /// Begin of the present stretch. The motor is on.
  Time on_since() const;

  /// When the motor went off: Time::min() if it never was on, Time::max() while it is.
  Time off_since() const;

  /// The earliest time at which a stretch may begin.
  Time ready_at() const;

  /// Begins a stretch, not before ready_at().
  void begin(Time time);

  /// Ends the stretch. `limited`: by a limit, so that the shortest rest follows.
  void end(Time time, bool limited);

  /// The motor was off from `time` on; what was entered for later did not happen.
  void forget_from(Time time);

  /// Moves all entries back in time.
  void age(Time by);

private:
  struct Stretch
  {
    Time cue; ///< begin of its cue
    Time begin;
    Time end;
  };

  Time cue_begin(Time begin) const;
  Time duty_end(Time begin, Time allowed) const;

  Time shortest_rest_;
  std::deque<Stretch> past_; ///< in order, disjoint, of the last kDutyWindow at least
  std::optional<Time> on_since_;
  Time ready_at_ = Time::min();
};

} // namespace tactor
