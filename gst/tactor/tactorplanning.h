// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "../standingtimes.h"
#include "tactor/command_planner.h"
#include "tactor/device_account.h"
#include "tactor/layout.h"
#include "tactorstream.h"

#include <gst/gst.h>

#include <memory>
#include <optional>
#include <vector>

/// Plans tactorsink's input: maps, gaps and the end become commands. Streaming thread, or while
/// there is none.
class TactorPlanning
{
public:
  struct Plan
  {
    std::vector<tactor::Command> commands;
    tactor::Time end{ 0 }; ///< running time at which these maps' frames end
  };

  /// Faults of the stream are posted by this element, which is not owned.
  explicit TactorPlanning(GstElement *element);

  /// Begins a play on a board of `tactors`, with Driver::layout(). `agreed` has settings that stay
  /// for the play: volts, max-lead and line. `motors` are those of the calibration, or
  /// empty. `account` is that of the board, which goes on from earlier plays; it may be null.
  void start(const tactor::PlannerSettings &agreed, int tactors, const tactor::Layout &layout,
             std::vector<tactor::MotorParameters> motors,
             std::shared_ptr<tactor::DeviceAccount> account);

  /// False if the caps are of maps and their grid is invalid.
  bool set_caps(const GstCaps *caps);

  /// When a buffer is shown; `now` is as for TactorStream::shown(). If that is unknown, it posts a
  /// warning.
  TactorStream::Span shown(GstBuffer *buffer, const GstSegment &segment,
                           std::optional<tactor::Time> now);
  /// Plans a buffer with the present settings and latency, but for those agreed on. None after an
  /// error message.
  std::optional<Plan> plan_map(GstBuffer *buffer, TactorStream::Span shown,
                               tactor::PlannerSettings settings);
  /// As TactorStream::is_shown().
  bool is_shown(GstClockTime pts, GstClockTime duration, const GstSegment &segment) const;
  Plan plan_gap(GstClockTime pts, GstClockTime duration, const GstSegment &segment);
  /// All tactors to zero when the last map's frame ends.
  Plan plan_rest();

  /// All motors have been at zero since this running time. Running time continues.
  void silenced(tactor::Time since);
  /// A flush at this running time is over. Running time restarts or continues.
  void flushed(tactor::Time at, bool resets_time);

  /// Cues cut by the limits since start().
  tactor::LimitCounters limited() const;

private:
  bool is_pooled(const tactor::PlannerSettings &settings) const;
  void check_grid(guint rows, guint columns, const tactor::PlannerSettings &settings);
  void check_number(const tactor::PlannerSettings &settings);

  GstElement *element_;
  TactorStream stream_;
  std::optional<tactor::CommandPlanner> planner_; ///< from start() on
  tactor::PlannerSettings agreed_;
  std::shared_ptr<tactor::DeviceAccount> account_;
  int tactors_ = 0;        ///< of the board
  tactor::Layout layout_;  ///< of the board
  guint checked_rows_ = 0; ///< grid compared with the board
  guint checked_columns_ = 0;
  tactor::Time last_end_{ 0 }; ///< running time of the end of the last map
  StandingTimes standing_;
  bool warned_no_meta_ = false;
  bool warned_grid_ = false;
  bool warned_untimed_ = false;
  bool told_number_ = false;
  std::vector<float> pooled_; ///< levels of the layout's tactors
};
