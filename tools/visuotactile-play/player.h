// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film.h"
#include "strip.h"

#include <gst/gst.h>

#include <functional>
#include <string>

/// How a film is played.
struct PlaySettings
{
  bool window = false;          ///< picture and sound on this machine, else a recording
  std::string recording;        ///< file of the recording
  std::string commands;         ///< file of the command trace
  std::string analysis_options; ///< properties of saliencytactile, as on a launch line
  std::string chair_options;    ///< properties of tactorsink, as on a launch line
  bool progress_in_place
      = false;        ///< progress rewrites its line (terminal) rather than adding lines
  bool quiet = false; ///< no progress
};

/// How it went.
struct PlayReport
{
  bool played = false;              ///< at least one frame
  bool stopped = false;             ///< by the user
  bool recorded = false;            ///< the recording is complete
  bool silent = false;              ///< there is sound in the film, but none that can be decoded
  std::string failure;              ///< why nothing could be played or written
  std::string ended_early;          ///< why the film ended before its end, if it did
  GstClockTime position = 0;        ///< running time of the end of the last frame
  GstClockTime reached = 0;         ///< of the end of the last frame or sound, whichever is later
  GstStructure *analysis = nullptr; ///< saliencytactile's stats, owned
  GstStructure *chair = nullptr;    ///< tactorsink's stats, owned

  PlayReport() = default;
  ~PlayReport();
  PlayReport(PlayReport &&other) noexcept;
  PlayReport &operator=(PlayReport &&) = delete;
};

/// The pipeline as a line for gst_parse_launch(), without the files that it writes: their names need not be UTF-8.
std::string launch_line(const Film &film, const PlaySettings &settings);

/// The pipeline as a command for a shell.
std::string shell_command(const Film &film, const PlaySettings &settings);

/// Whether a picture can be shown here.
bool have_display();

/// Plays the film to its end, or until SIGINT, SIGTERM or SIGHUP, and leaves complete files.
PlayReport play(const Film &film, const PlaySettings &settings, Strip &strip);
