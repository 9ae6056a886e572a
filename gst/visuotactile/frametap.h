// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "groupshift.h"
#include "playgate.h"

#include <gst/gst.h>

#include <atomic>
#include <functional>

/// Hands the frames and events of a pad on to a branch beside it, whose thread takes them from a
/// leaky queue: the pad's stream neither waits for the branch nor fails with it. Frames are not
/// copied. State changes call start() and stop(), sinks' events come on any thread.
class FrameTap
{
public:
  /// `watched` is a sink pad, `branch` one that drops data that it cannot take in time. Flushes
  /// reach the gate. `changed` is called when ended() or pixels() may have changed.
  FrameTap(GstPad *watched, GstPad *branch, PlayGate &gate, std::function<void()> changed);
  ~FrameTap();
  FrameTap(const FrameTap &) = delete;
  FrameTap &operator=(const FrameTap &) = delete;

  /// Before the first stream.
  void begin();
  /// Frames pass from now on, also in the middle of a stream.
  void start();
  /// No frame passes any more.
  void stop();
  /// An upstream event of the sinks behind the pad.
  void hear(GstEvent *event);
  /// The end of the stream has passed, and no new one since.
  bool ended() const;
  /// Pixels of a frame, by the caps of the stream.
  gint64 pixels() const;

private:
  static GstPadProbeReturn probe(GstPad *pad, GstPadProbeInfo *info, gpointer self);
  static gboolean query(GstPad *pad, GstObject *parent, GstQuery *query);
  void catch_up();
  void follow(GstEvent *event);
  void pass(GstEvent *event);
  void pass(GstBuffer *frame);

  PlayGate &gate_;
  const std::function<void()> changed_;
  GstPad *watched_;
  GstPad *pad_; ///< a source pad without an element
  gulong probe_ = 0;
  GroupShift shift_;
  guint32 seqnum_ = GST_SEQNUM_INVALID; ///< of the segment
  std::atomic<bool> told_{ false };     ///< the branch has got the events of the stream
  std::atomic<bool> open_{ false };
  std::atomic<bool> ended_{ false };
  std::atomic<gint64> pixels_{ 0 };
};
