// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// Latency queries: sending and answering.
namespace latency {

/// The latency of an answered query.
inline bool
is_live(GstQuery *answered)
{
  gboolean live = FALSE;
  gst_query_parse_latency(answered, &live, nullptr, nullptr);
  return live;
}

/// Whether the upstream of a sink pad is live: it does not wait for the element.
inline bool
is_live(GstPad *sink_pad)
{
  g_autoptr(GstQuery) query = gst_query_new_latency();
  return gst_pad_peer_query(sink_pad, query) && is_live(query);
}

/// Adds an element's own latency to the answer of its upstream.
inline void
add(GstQuery *answered, GstClockTime own)
{
  gboolean live = FALSE;
  GstClockTime min = 0;
  GstClockTime max = GST_CLOCK_TIME_NONE;
  gst_query_parse_latency(answered, &live, &min, &max);
  gst_query_set_latency(answered, live, min + own, GST_CLOCK_TIME_IS_VALID(max) ? max + own : max);
}

} // namespace latency
