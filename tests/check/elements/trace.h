// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/command_trace.h"

#include <map>
#include <vector>

// After the standard library's headers: gstcheck.h defines a macro named fail.
#include "../unwrap.h"
#include <gst/check/gstcheck.h>

/// Whatever happened, each motor's last command is zero.
inline void
assert_silent_at_end(const std::vector<tactor::IssuedCommand> &lines)
{
  std::map<int, double> last;
  for (const tactor::IssuedCommand &line : lines)
    last[line.command.tactor] = line.command.volts;
  for (const auto &[tactor, volts] : last)
    fail_unless(volts == 0, "tactor %d is left at %g V", tactor, volts);
}
