// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/command_planner.h"
#include "tactorstream.h"

#include <gst/gst.h>

#include <optional>
#include <vector>

/// What tactorsink makes of what comes in: maps, gaps and ends become commands. In the streaming
/// thread only, or while there is none.
class TactorPlanning
{
public:
  struct Plan
  {
    std::vector<tactor::Command> commands;
    tactor::Time end{ 0 }; ///< running time until which that is shown which they are for
  };

  /// Says what is wrong with the stream on this element's bus. The element is not owned.
  explicit TactorPlanning(GstElement *element);

  /// Begins a play with what was agreed on with a board of so many tactors, and with its motors if
  /// they were measured.
  void start(const tactor::PlannerSettings &agreed, int tactors,
             std::vector<tactor::MotorParameters> motors);

  /// False if these are caps of maps with a grid that cannot be.
  bool set_caps(const GstCaps *caps);

  /// Plans a buffer with what is set now, but for what was agreed on. Nothing after an error
  /// message.
  std::optional<Plan> plan_map(GstBuffer *buffer, const GstSegment &segment,
                               tactor::PlannerSettings settings);
  /// Whether a buffer or a gap is one that is shown.
  bool is_shown(GstClockTime pts, GstClockTime duration, const GstSegment &segment) const;
  Plan plan_gap(GstClockTime pts, GstClockTime duration, const GstSegment &segment);
  /// Rest when the last map has been shown.
  Plan plan_rest();

  /// All motors have been at zero since this running time. Maps that come next belong to the same
  /// film.
  void silenced(tactor::Time since);
  /// A flush at this running time is over, and running time begins anew or goes on.
  void flushed(tactor::Time at, bool resets_time);

  /// Cues that the limits have cut since start().
  tactor::LimitCounters limited() const;

private:
  void check_grid(guint rows, guint columns, const tactor::PlannerSettings &settings);

  GstElement *element_;
  TactorStream stream_;
  std::optional<tactor::CommandPlanner> planner_; ///< from start() on
  tactor::PlannerSettings agreed_;
  int tactors_ = 0;        ///< of the board
  guint checked_rows_ = 0; ///< grid that was compared with the board
  guint checked_columns_ = 0;
  tactor::Time last_end_{ 0 }; ///< running time of the end of the last map
  bool warned_no_meta_ = false;
  bool warned_grid_ = false;
};
