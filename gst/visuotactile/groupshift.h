// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

#include <mutex>

/// The running time of the sinks minus that of a decoder. In a gapless play each film begins at
/// zero in its decoder, and playbin's streamsynchronizer, which is behind it, adds the lengths of
/// the films before. A film's own length is the first estimate; upstream events of the sinks carry
/// the exact value (gst_event_get_running_time_offset()). Events of sinks come on any thread, the
/// rest on the streaming thread.
class GroupShift
{
public:
  /// A film begins. Without a flush since the last one, it is played after that one.
  void start_stream(GstEvent *stream_start);
  void flush();
  /// The segment as the sinks get it.
  GstSegment open(const GstSegment &segment);
  /// A frame passes. Returns whether the segment has changed, for segment() to be sent before it.
  bool pass(GstBuffer *frame);
  /// The last segment that was opened, as the sinks get it.
  GstSegment segment() const;
  /// A QoS event of a sink.
  void hear(GstEvent *qos);

private:
  mutable std::mutex mutex_;
  GstSegment segment_ = unknown(); ///< as the decoder sends it
  GstClockTime shift_ = 0;
  bool changed_ = false;
  bool any_ = false;       ///< a frame has passed since the segment began
  GstClockTime first_ = 0; ///< running times of the segment's frames, its base left out
  GstClockTime end_ = 0;
  guint group_ = GST_GROUP_ID_INVALID;
  GstClockTime length_ = 0; ///< of all that was played of this film since its start or a flush

  static GstSegment unknown();
};
