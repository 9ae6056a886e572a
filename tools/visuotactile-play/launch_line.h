// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/film.h"
#include "film/sound.h"

#include <string>

/// How a film is played.
struct PlaySettings
{
  bool window = false;          ///< picture and sound on this machine
  bool titled = false;          ///< the window is ours, not the sink's
  std::string picture;          ///< the picture's sink; empty: one that fits the others
  std::string recording;        ///< file of the recording, without a window; empty: none
  std::string commands;         ///< file of the command trace; empty: none
  std::string analysis_options; ///< properties of saliencytactile, as on a launch line
  std::string chair;            ///< the sink of the maps with its properties, as on a launch line
  bool has_trace = false;       ///< the sink is tactorsink, which has a trace and statistics
  bool overlay = true;          ///< the window shows the map
  bool meter = false;           ///< the overlay shows events against the floor
  bool quiet = false;           ///< no progress
  std::string plays_on;         ///< printed with it
  std::string track;            ///< a file of text cues that replace all other maps; empty: none
  const fusion::Profile *sound = nullptr; ///< of the film's sound; null: none is felt
};

/// An encoder in real time, as on a launch line. Throws std::runtime_error if there is none.
std::string video_encoder();

/// The pipeline for gst_parse_launch(), without the names of output files, which need not be UTF-8.
std::string launch_line(const Film &film, const PlaySettings &settings);

/// The pipeline as a shell command.
std::string shell_command(const Film &film, const PlaySettings &settings);
