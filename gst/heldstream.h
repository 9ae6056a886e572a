// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

#include <deque>
#include <functional>

/// Holds the buffers and serialized events of a pad until a given time of the stream has come after
/// them. Nothing here blocks. Streaming thread, or while there is none.
class HeldStream
{
public:
  struct Ways
  {
    std::function<GstFlowReturn(GstBuffer *)> pass;
    std::function<gboolean(GstEvent *)> pass_event;
  };

  explicit HeldStream(Ways ways);
  ~HeldStream();
  HeldStream(const HeldStream &) = delete;
  HeldStream &operator=(const HeldStream &) = delete;

  /// Limit of held items. One buffer above it releases all of them, one event the oldest item.
  static constexpr std::size_t kMost = 4096;

  /// Takes a buffer, and passes those that `time` of the stream follows. Buffers without a duration
  /// hold nothing back.
  GstFlowReturn hold(GstBuffer *buffer, GstClockTime time);
  /// Takes an event, which comes after the held items.
  gboolean hold(GstEvent *event);
  /// Shows the held buffers, the next one first, until one is `enough`.
  void look_through(const std::function<bool(GstBuffer *)> &enough) const;
  /// Passes all.
  GstFlowReturn drain();
  /// Drops all but what outlives a flush: sticky events, but for SEGMENT and EOS. To be called when
  /// the flush has passed.
  void flush();
  /// Drops all.
  void clear();

private:
  GstFlowReturn pass_first();

  const Ways ways_;
  std::deque<GstMiniObject *> held_;
  GstClockTime length_ = 0; ///< of the held buffers
};
