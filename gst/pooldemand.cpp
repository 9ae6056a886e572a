// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pooldemand.h"

#include <gst/video/video.h>

#include <cmath>

void
demand_buffers(GstQuery *query, GstClockTime time, guint more)
{
  GstCaps *caps = nullptr;
  GstVideoInfo info;
  gst_query_parse_allocation(query, &caps, nullptr);
  if (caps == nullptr || !gst_video_info_from_caps(&info, caps))
    return;
  const double fps = info.fps_n > 0 ? static_cast<double>(info.fps_n) / info.fps_d : 30.0;
  const double held = static_cast<double>(time) / GST_SECOND;
  more = static_cast<guint>(MIN(std::ceil(held * fps) + more, 256.0));

  const guint pools = gst_query_get_n_allocation_pools(query);
  if (pools == 0)
    gst_query_add_allocation_pool(query, nullptr, static_cast<guint>(MIN(info.size, G_MAXUINT)),
                                  more, 0);
  for (guint i = 0; i < pools; i++) {
    g_autoptr(GstBufferPool) pool = nullptr;
    guint size = 0;
    guint min = 0;
    guint max = 0;
    gst_query_parse_nth_allocation_pool(query, i, &pool, &size, &min, &max);
    gst_query_set_nth_allocation_pool(query, i, pool, size, min + more, max > 0 ? max + more : 0);
  }
}
