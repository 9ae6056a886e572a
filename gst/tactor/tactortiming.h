// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <gst/gst.h>

#include <atomic>
#include <chrono>

#include <memory>
#include <optional>
#include <utility>

/// How running time and clock time relate at one moment. Not to be kept: a pause, a new clock or a
/// new latency changes it.
class TactorTiming
{
public:
  /// Takes the clock, which may be NULL: then everything is due at once. `offset` is clock time −
  /// running time: base time + latency + ts-offset.
  TactorTiming(GstClock *clock, GstClockTimeDiff offset) : clock_(clock), offset_(offset)
  {
  }
  TactorTiming(const TactorTiming &other)
      : clock_(other.clock_ ? GST_CLOCK(gst_object_ref(other.clock_.get())) : nullptr),
        offset_(other.offset_)
  {
  }
  TactorTiming(TactorTiming &&) = default;
  TactorTiming &operator=(TactorTiming other)
  {
    std::swap(clock_, other.clock_);
    offset_ = other.offset_;
    return *this;
  }

  tactor::Time running_time(GstClockTime clock_time) const
  {
    return tactor::Time(static_cast<gint64>(clock_time) - offset_);
  }
  /// The running time now; none without a clock.
  std::optional<tactor::Time> now() const
  {
    if (!clock_)
      return std::nullopt;
    return running_time(gst_clock_get_time(clock_.get()));
  }
  /// Whether a sound card or server is the clock.
  bool is_of_sound() const
  {
    const GType audio_clock = g_type_from_name("GstAudioClock"); // 0 in a process without one
    return clock_ && audio_clock != 0 && G_TYPE_CHECK_INSTANCE_TYPE(clock_.get(), audio_clock);
  }
  /// To wait until a running time on the clock. Transfer full; NULL if that is before clock time 0.
  GstClockID new_wait(tactor::Time until) const
  {
    const GstClockTimeDiff time = until.count() + offset_;
    return time > 0 ? gst_clock_new_single_shot_id(clock_.get(), static_cast<GstClockTime>(time))
                    : nullptr;
  }

private:
  struct Unref
  {
    void operator()(GstClock *clock) const
    {
      gst_object_unref(clock);
    }
  };

  std::unique_ptr<GstClock, Unref> clock_;
  GstClockTimeDiff offset_;
};

/// Decides when a clock of sound is not read: when sound begins or continues. Some servers report
/// any time for a moment (PipeWire 0.3.65: until its first answer), from which GstClock never goes
/// back: the film stands still. Any thread.
class ClockRest
{
public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kLength{ 40 };

  /// The play begins or goes on.
  void begin(const TactorTiming &timing)
  {
    if (timing.is_of_sound())
      end_ = Clock::now() + kLength;
  }
  /// The clock is not to be read before.
  Clock::time_point end() const
  {
    return end_;
  }

private:
  std::atomic<Clock::time_point> end_{ Clock::time_point{} };
};
