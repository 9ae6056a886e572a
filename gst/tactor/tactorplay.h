// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactorplanning.h"
#include "tactorsession.h"

#include <gst/base/gstbasesink.h>

/// tactorsink's stream: maps, gaps and the end are planned once the board is open, and the
/// scheduler gets the commands. Streaming thread, or while it is stopped, but for limited().
class TactorPlay
{
public:
  /// Neither is owned: this is a part of the sink.
  TactorPlay(GstBaseSink *sink, TactorSession &session);

  /// Before PAUSED.
  void begin();
  /// Waits until the board is open. With the preroll lock, which is released meanwhile.
  GstFlowReturn wait_until_open();
  /// False if the caps are of maps and their grid is invalid.
  bool set_caps(const GstCaps *caps);

  /// ERROR after an error message.
  GstFlowReturn play_map(GstBuffer *buffer, tactor::PlannerSettings settings);
  void play_gap(GstClockTime pts, GstClockTime duration);
  /// Waits until the last map has been shown and the motors are at zero. With the preroll lock,
  /// which is released meanwhile.
  GstFlowReturn drain();

  void flush_started();
  void flush_stopped(bool resets_time);
  /// The stream jumps over frames. Their commands are dropped.
  void stepped();

  /// Cues cut by the limits since begin(). Any thread.
  tactor::LimitCounters limited() const;

private:
  GstSegment segment() const;
  std::optional<tactor::Time> paced_time() const;
  void push(const TactorPlanning::Plan &plan);

  GstBaseSink *sink_;
  TactorSession &session_;
  TactorScheduler &scheduler_; ///< the session's
  TactorPlanning planning_;
  bool plans_ = false;            ///< planning was started
  tactor::Time flushed_at_{ 0 };  ///< running time of the last flush
  tactor::LimitCounters limited_; ///< guarded by the object lock
};
