// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <gst/gst.h>

#include <optional>

/// The position of a film's time 0 in GStreamer's stream time: docs/design/time.md has the 0:00 of
/// players in each container.
///
/// The first segment of a film shows whether its container has a time line of its own. MP4 and
/// Matroska have: there time 0 is stream time 0. Transport streams, program streams and recordings
/// count from a clock, which began before the first picture. There time 0 is the earliest time of
/// picture or sound.
///
/// A value type, not thread-safe.
class FilmStart
{
public:
  /// A segment of one of the film's streams. The first counts, which is before any seek.
  void add_segment(const GstSegment &segment);

  /// The first time stamp of a stream of picture or sound, in its segment at that time.
  void add_first(const GstSegment &segment, GstClockTime timestamp);

  /// The stream time of the film's time 0.
  visuotactile::Time stream_time() const;

  /// The running time of the film's time 0 where the film is played from its beginning. Not
  /// positive: a player begins with the first stream that it knows, which may not be the earliest.
  visuotactile::Time running_time() const;

private:
  std::optional<visuotactile::Time> begin_; ///< stream time at which the first segment begins
  std::optional<visuotactile::Time> first_; ///< earliest stream time
};
