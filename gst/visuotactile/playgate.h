// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

#include <mutex>

/// Holds the buffers of a pad back from a flush until the pipeline plays again. Sinks that preroll
/// do that by themselves. One that does not would play while the pipeline prerolls, and on through
/// a pause that comes meanwhile: GStreamer (1.22) pauses only what has lost its state.
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
  bool flushed_ = false; ///< and nothing else since
  gulong closed_ = 0;    ///< the probe that blocks the pad
};
