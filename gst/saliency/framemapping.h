// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/frame_view.h"

#include <gst/video/video.h>

/// Raw formats that saliency::FrameView supports, for caps.
#define FRAME_MAPPING_FORMATS                                                                      \
  "{ I420, YV12, NV12, NV21, YUY2, UYVY, Y42B, Y444, RGB, BGR, RGBx, BGRx, xRGB, xBGR, RGBA, "     \
  "BGRA, ARGB, ABGR, GRAY8, "                                                                      \
  "I420_10LE, P010_10LE }"

/// A buffer mapped for reading during this object's life, as a saliency::FrameView. A
/// GstVideoCropMeta limits the view.
class FrameMapping
{
public:
  FrameMapping(const GstVideoInfo &info, GstBuffer *buffer);
  ~FrameMapping();
  FrameMapping(const FrameMapping &) = delete;
  FrameMapping &operator=(const FrameMapping &) = delete;

  /// False if the buffer cannot be mapped, or is smaller than its format requires.
  explicit operator bool() const
  {
    return mapped_;
  }

  const saliency::FrameView &view() const
  {
    return view_;
  }

  /// Pixel of the frame at the view's top left.
  int left() const
  {
    return left_;
  }
  int top() const
  {
    return top_;
  }

private:
  GstVideoFrame frame_;
  bool mapped_;
  int left_ = 0;
  int top_ = 0;
  saliency::FrameView view_;
};
