// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/film.h"
#include "launch_line.h"
#include "strip.h"

#include <gst/gst.h>

#include <memory>
#include <string>

struct FreeStructure
{
  void operator()(GstStructure *structure) const
  {
    gst_structure_free(structure);
  }
};
using Stats = std::unique_ptr<GstStructure, FreeStructure>;

/// The result of a play.
struct PlayReport
{
  bool played = false;         ///< at least one frame
  bool stopped = false;        ///< by the user
  bool recorded = false;       ///< the recording is complete
  bool motors_may_run = false; ///< see motors_may_run()
  bool silent = false;         ///< there is sound in the film, but none that can be decoded
  std::string failure;         ///< why nothing could be played or written, or empty
  std::string ended_early;     ///< the error at which a broken film ended, or empty
  GstClockTime position = 0;   ///< the film's time at the end of the last frame
  GstClockTime reached = 0;    ///< of the end of the last frame or sound, whichever is later
  bool moved = false;          ///< by keys
  Stats analysis;              ///< of saliencytactile
  Stats chair;                 ///< tactorsink's actuation-stats, or null
};

/// Plays the film to its end, or until SIGINT, SIGTERM or SIGHUP. All files are complete then.
/// `strip`, if any, is offered each frame.
PlayReport play(const Film &film, const PlaySettings &settings, Strip *strip);
