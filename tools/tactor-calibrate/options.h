// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "player.h"

#include "calibration/envelope.h"
#include "film/command_line.h"
#include "film/user_defaults.h"

#include <glib.h>

#include <atomic>
#include <string>
#include <vector>

/// The options of measure and check: which board is driven, and which source records it.
struct PlayOptions
{
  TextOption driver{ "auto" };
  TextOption device{};
  TextOption frequency{ "60" };
  gint channels = 2;
  TextOption source{ "autoaudiosrc" };
  TextOption simulated_motors{};
  UserDefaults defaults{ "tactor-calibrate" };

  /// These options, filled with the user's settings, and a command's own, ended by an empty one.
  std::vector<GOptionEntry> with(std::initializer_list<GOptionEntry> own);
  /// After the command line is read. Throws UsageError.
  PlayerSettings settings(double volts_max);
};

/// `0,2,5` or `0-8`. Throws UsageError.
std::vector<int> parse_tactors(const std::string &text);

/// `LOW:HIGH` in Hz; {0, 0} for an empty text. Throws UsageError.
tactor::Band parse_band(const std::string &text);

/// True after SIGINT or SIGTERM. Installs the handlers.
const std::atomic<bool> &interruption();
