// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

#include <functional>

/// Warns of a deadlock at preroll because a queue is missing: one thread feeds this sink and
/// another one, through a tee, a demuxer or tactileextractor. The sink that has its first frame
/// blocks the thread, so that the other one never gets its own. The watch looks once a second on
/// the system clock; if it finds this three times in a row, it posts a warning, once for each
/// start(). It finds nothing in a normal pause, when all sinks have their frames.
class QueueWatch
{
public:
  explicit QueueWatch(GstElement *sink) : sink_(sink)
  {
  }
  ~QueueWatch()
  {
    stop();
  }
  QueueWatch(const QueueWatch &) = delete;
  QueueWatch &operator=(const QueueWatch &) = delete;

  /// From READY to PAUSED. Nothing is reported while `is_ready`, called on a thread of GStreamer's,
  /// returns false: the sink waits for something else. This and stop() run on the thread that
  /// changes the sink's state.
  void start(std::function<bool()> is_ready);
  void stop();

private:
  GstElement *sink_; ///< not owned: it owns this
  GstClockID looks_ = nullptr;
};
