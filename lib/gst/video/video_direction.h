// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/orientation.h"

#include <gst/video/video.h>

#include <string>

/// The display orientation in the tags of a stream (GST_TAG_IMAGE_ORIENTATION), as videoflip
/// and video sinks interpret them. The stream's own tag takes precedence over the global one. Both
/// survive flushes and seeks, and are replaced by later tags or by a new stream. Not thread-safe:
/// call from the streaming thread, or while there is none.
class OrientationTags
{
public:
  /// Handles TAG and STREAM_START; ignores other events.
  void follow(GstEvent *event);

  /// Forgets the stream and its tags.
  void reset();

  /// Never GST_VIDEO_ORIENTATION_AUTO.
  GstVideoOrientationMethod method() const;

private:
  /// No tag; method() is then the identity.
  static constexpr GstVideoOrientationMethod kUnsaid = GST_VIDEO_ORIENTATION_AUTO;

  GstVideoOrientationMethod global_ = kUnsaid;
  GstVideoOrientationMethod stream_ = kUnsaid;
  std::string stream_id_;
};

/// The orientation for a `video-direction` property: GST_VIDEO_ORIENTATION_AUTO follows the tags,
/// GST_VIDEO_ORIENTATION_CUSTOM is the identity.
tactile::Orientation orientation_of(GstVideoOrientationMethod wanted, const OrientationTags &tags);

/// The orientation in the tags that came to a pad. Any thread.
GstVideoOrientationMethod direction_at(GstPad *pad);
