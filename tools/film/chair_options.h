// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "command_line.h"

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

  /// For Usage::more. They point into this object.
  std::array<GOptionEntry, 7> entries();
  /// Throws UsageError.
  void check() const;
  /// The launch line of a tactorsink.
  std::string sink_line() const;
};
