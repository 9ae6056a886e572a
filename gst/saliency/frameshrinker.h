// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/video/video.h>

/// Where a picture of a frame is: pixel x of the frame is sample offset + scale x of the picture,
/// where both begin and end at edges.
struct Placement
{
  double scale_x = 1;
  double scale_y = 1;
  double offset_x = 0;
  double offset_y = 0;
};

/// The properties of a small picture.
struct SmallPicture
{
  GstVideoInfo info;
  Placement placement{};
  int frame_width = 0;
  int frame_height = 0;
};

/// Makes small pictures of frames that the CPU reads slowly or not at all. Frames stay as they are.
/// One streaming thread at a time.
class FrameShrinker
{
public:
  virtual ~FrameShrinker() = default;

  /// A picture in memory that can be mapped, of a format that FrameMapping reads, and its
  /// properties. Each side of the frame is halved as often as the shrinker was made for. It may
  /// refer to the shrinker's own memory: release it before the next call. Transfer full; NULL if
  /// this frame cannot be shrunk.
  virtual GstBuffer *shrink(GstBuffer *frame, SmallPicture &picture) = 0;
};
