// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "../standingtimes.h"
#include "nanoseconds.h"

#include <gst/video/video.h>

#include <optional>

/// When frames are shown, on a time line that rises in reverse playback, too.
class FrameTimes
{
public:
  struct Span
  {
    visuotactile::Time time{ 0 };
    visuotactile::Time duration{ 0 };
  };

  /// Frames by which a time stamp may step back in a continuous stream. Frames in the order of
  /// decoding step back by as many as are between two references, of which encoders make up to 7.
  static constexpr int kReorder = 8;

  /// The next frame. Without a time stamp, or with that of the last one, it follows the last one.
  /// So does one whose time stamp steps back a little: frames come as they are shown, and some
  /// muxers and decoders swap their time stamps.
  Span of(GstBuffer *frame, const GstVideoInfo &info, const GstSegment &segment);
  /// The next frame follows no other.
  void reset();
  /// As StandingTimes::is_news().
  bool stand()
  {
    return standing_.is_news();
  }

private:
  StandingTimes standing_;
  visuotactile::Time next_{ 0 };             ///< for frames without a time stamp of their own
  std::optional<visuotactile::Time> last_{}; ///< of the last frame
};
