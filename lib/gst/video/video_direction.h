// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/orientation.h"

#include <gst/video/video.h>

#include <string>

/// How a stream's tags say that its picture is to be turned when it is shown
/// (GST_TAG_IMAGE_ORIENTATION), as videoflip and video sinks take them: the stream's own tag counts
/// more than that of the whole file, both hold over flushes and seeks, until other tags come or
/// another stream. One thread at a time: the streaming thread, or while there is none.
class OrientationTags
{
public:
  /// Takes note of TAG and STREAM_START; other events mean nothing.
  void follow(GstEvent *event);

  /// No stream any more.
  void reset();

  /// Never GST_VIDEO_ORIENTATION_AUTO.
  GstVideoOrientationMethod method() const;

private:
  /// As it is (identity) where tags say nothing.
  static constexpr GstVideoOrientationMethod kUnsaid = GST_VIDEO_ORIENTATION_AUTO;

  GstVideoOrientationMethod global_ = kUnsaid;
  GstVideoOrientationMethod stream_ = kUnsaid;
  std::string stream_id_;
};

/// How the picture is turned that a user wants shown like this: GST_VIDEO_ORIENTATION_AUTO by the
/// tags, `custom` not at all.
tactile::Orientation orientation_of(GstVideoOrientationMethod wanted, const OrientationTags &tags);

/// A property `video-direction` as other elements have it, by default GST_VIDEO_ORIENTATION_AUTO.
GParamSpec *video_direction_spec(const gchar *blurb, GParamFlags flags);
