// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

#include <functional>

/// Tells whoever plays a sink that the pipeline waits for ever because a queue is missing: one
/// thread feeds this sink and another one, by a tee, a demuxer or tactileextractor, and is held by
/// the one that has its first frame while the other still waits for its own. It looks once a
/// second, on GStreamer's system clock, while the sink is paused; what was so at three looks in a
/// row is a warning on the bus, once a start. A pause of the user's is none of it: all sinks have
/// their frames then.
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

  /// From READY to PAUSED. Nothing is wrong yet while `is_ready`, which is asked on a thread of
  /// GStreamer's, says that the sink waits for something else. This and stop(): on the thread that
  /// changes the sink's state.
  void start(std::function<bool()> is_ready);
  void stop();

private:
  GstElement *sink_; ///< not owned: this is a part of it
  GstClockID looks_ = nullptr;
};
