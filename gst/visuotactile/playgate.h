// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

#include <mutex>

/// Blocks the buffers of a pad from a flush until the pipeline plays again, as sinks that preroll
/// do by themselves. Another sink would play while the pipeline prerolls, and through a pause in
/// this time: GStreamer (1.22) pauses only elements that have lost their state.
class PlayGate
{
public:
  /// `owner` is the bin whose pipeline it is, `pad` a source pad.
  PlayGate(GstElement *owner, GstPad *pad);
  ~PlayGate();
  PlayGate(const PlayGate &) = delete;
  PlayGate &operator=(const PlayGate &) = delete;

  /// The stream was flushed. Streaming thread.
  void flush();
  /// A frame passes. The sinks have seen the flush before it, so the pipeline prerolls, or is
  /// paused in spite of it. Streaming thread.
  void pass();
  /// The owner's state changes to PLAYING, or down to READY.
  void open();

private:
  bool pipeline_plays() const;

  GstElement *owner_;
  GstPad *pad_;
  std::mutex mutex_{};
  bool flushed_ = false; ///< nothing has passed since a flush
  gulong closed_ = 0;    ///< the probe that blocks the pad
};
