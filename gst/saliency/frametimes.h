// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <gst/video/video.h>

/// When frames are shown, on a time line that rises in reverse playback, too.
class FrameTimes
{
public:
  struct Span
  {
    visuotactile::Time time{ 0 };
    visuotactile::Time duration{ 0 };
  };

  /// The next frame. Without a time stamp it follows the last one.
  Span of(GstBuffer *frame, const GstVideoInfo &info, const GstSegment &segment);
  /// The next frame follows no other.
  void reset();

private:
  visuotactile::Time next_{ 0 }; ///< for frames without a time stamp
};
