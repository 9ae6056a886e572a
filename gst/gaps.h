// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// Whether a GAP stands for what was lost on the way rather than for nothing to be felt. What was
/// before holds, as it does where no data come.
inline bool
is_loss(GstEvent *gap)
{
  GstGapFlags flags{};
  gst_event_parse_gap_flags(gap, &flags);
  return (flags & GST_GAP_FLAG_MISSING_DATA) != 0;
}
