// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/film.h"
#include "launch_line.h"
#include "strip.h"

#include <gst/gst.h>

#include <string>

/// What happened during a play.
struct PlayReport
{
  bool played = false;              ///< at least one frame
  bool stopped = false;             ///< by the user
  bool recorded = false;            ///< the recording is complete
  bool motors_may_run = false;      ///< see motors_may_run()
  bool silent = false;              ///< there is sound in the film, but none that can be decoded
  std::string failure;              ///< why nothing could be played or written, or empty
  std::string ended_early;          ///< the error at which a broken film ended, or empty
  GstClockTime position = 0;        ///< the film's time at the end of the last frame
  GstClockTime reached = 0;         ///< of the end of the last frame or sound, whichever is later
  GstStructure *analysis = nullptr; ///< saliencytactile's stats, owned
  GstStructure *chair = nullptr;    ///< tactorsink's actuation-stats, owned, or null

  PlayReport() = default;
  ~PlayReport();
  PlayReport(PlayReport &&other) noexcept;
  PlayReport &operator=(PlayReport &&) = delete;
};

/// Plays the film to its end, or until SIGINT, SIGTERM or SIGHUP. All files are complete then.
/// `strip`, if any, is offered each frame.
PlayReport play(const Film &film, const PlaySettings &settings, Strip *strip);
