// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/chair_options.h"

#include <string>

/// The command line of `tactile-track desk`. tactile-track reads it for help and errors,
/// tactile-track-desk to run.
struct DeskOptions
{
  gboolean review = FALSE;
  gint port = 0; ///< 0: any
  gboolean no_browser = FALSE;
  TextOption tracks{}; ///< a library; empty: none
  ChairOptions chair;
  CommonOptions common;
  std::string film;
  std::string track; ///< empty: the one beside the film
};

/// Throws UsageError or Help.
void read_desk_options(int argc, char **argv, DeskOptions &options, UserDefaults &defaults);
