// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// Whether a GAP stands for lost data rather than for silence. The last map then holds, as it does
/// without data.
inline bool
is_loss(GstEvent *gap)
{
  GstGapFlags flags{};
  gst_event_parse_gap_flags(gap, &flags);
  return (flags & GST_GAP_FLAG_MISSING_DATA) != 0;
}
