// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <gst/gst.h>

#include <memory>
#include <optional>

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

  GstClock *clock() const
  {
    return clock_.get();
  }
  /// May be negative.
  GstClockTimeDiff clock_time(tactor::Time running_time) const
  {
    return running_time.count() + offset_;
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
