// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "command_line.h"
#include "user_defaults.h"

#include <array>
#include <string>

/// The options of programs that play a track on the chair.
struct ChairOptions
{
  TextOption driver{ "auto" };
  TextOption device{};
  TextOption mapping{};
  TextOption calibration{};
  TextOption trace{};
  gdouble intensity = 1;
  gboolean mute = FALSE; ///< a setting of the user alone
  gdouble delay = 0;     ///< likewise

  /// Before the command line is read.
  void fill(UserDefaults &defaults);
  /// For Usage::more. They point into this object.
  std::array<GOptionEntry, 7> entries();
  /// After it. Throws UsageError.
  void check(UserDefaults &defaults) const;
  /// The launch line of a tactorsink.
  std::string sink_line() const;
};
