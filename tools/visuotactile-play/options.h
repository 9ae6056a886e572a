// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "devices.h"

#include "film/command_line.h"

#include <glib.h>

#include <limits>
#include <string>
#include <vector>

inline constexpr const char *kProgram = "visuotactile-play";
inline constexpr gint kOfDevice = G_MININT; ///< side of the grid: the device's, else kPaperSide
/// 5 Hz; of a track every cue, as written.
inline constexpr gdouble kUsualRate = std::numeric_limits<gdouble>::lowest();

/// The command line, over the settings of the user.
struct Options
{
  TextOption output{};
  TextOption profile{ "tuned" };
  TextOption people{ "auto" };
  TextOption camera{ "off" };
  TextOption sound{ "off" };
  TextOption compensation{ "exact" };
  TextOption driver{ "auto" };
  TextOption device{};
  TextOption tracks{};
  TextOption mapping{};     ///< a setting of the user alone
  TextOption calibration{}; ///< likewise
  gint channels = 2;
  gdouble intensity = 1;
  gboolean mute = FALSE; ///< likewise
  gdouble delay = 0;     ///< likewise, in ms
  gint rows = kOfDevice;
  gint columns = kOfDevice;
  gdouble rate = kUsualRate;
  gdouble sensitivity = 1;
  gdouble density = 0;
  gboolean no_window = FALSE;
  gboolean print_pipeline = FALSE;
  gboolean list_devices = FALSE;
  gboolean feel_test = FALSE;
  gint motor = 0; ///< of the feel test; 0: all
  gboolean release_boards = FALSE;
  gboolean version = FALSE;
  CommonOptions common;
  std::string plays_on; ///< the driver and its reason, to be printed when something plays
  std::vector<std::string> films;
};

/// Throws UsageError or Help.
void read_command_line(int argc, char **argv, Options &options);

ChosenDevice chosen_device(const Options &options);
