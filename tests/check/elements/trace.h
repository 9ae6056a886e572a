// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/command_trace.h"

#include <map>
#include <string>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/unwrap.h"
#include <gst/check/gstcheck.h>

/// Commands that no map caused: those of pause, resume, flush and mute.
inline bool
is_unplanned(const tactor::IssuedCommand &line)
{
  return line.command.lead == tactor::Time(0) && line.command.effect == line.issued;
}

/// What planned zeros, which have no rise time, were led by.
inline std::vector<tactor::Time>
leads_of_zeros(const std::string &trace)
{
  std::vector<tactor::Time> leads;
  for (const tactor::IssuedCommand &line : unwrap(tactor::read_command_trace(trace)))
    if (line.command.volts == 0 && !is_unplanned(line))
      leads.push_back(line.command.lead);
  return leads;
}

/// Each motor's last command must be zero.
inline void
assert_silent_at_end(const std::vector<tactor::IssuedCommand> &lines)
{
  std::map<int, double> last;
  for (const tactor::IssuedCommand &line : lines)
    last[line.command.tactor] = line.command.volts;
  for (const auto &[tactor, volts] : last)
    fail_unless(volts == 0, "tactor %d is left at %g V", tactor, volts);
}
