// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "framereader.h"
#include "people/people.h"

#include <gst/gst.h>

#include <optional>
#include <span>

/// Counts and times of saliencytactile, for its property `stats`. Not thread-safe.
struct SaliencyStatistics
{
  guint64 frames = 0;    ///< passed
  guint64 analyzed = 0;  ///< of frames
  guint64 unchanged = 0; ///< not analyzed, as they showed nothing new
  guint64 active = 0;    ///< frames with any level above zero
  GstClockTime busy = 0;
  GstClockTime longest = 0;
  people::People::Statistics people;
  FrameReader::Path path = FrameReader::Path::none;
  guint64 bytes = 0; ///< of small pictures

  /// A frame with these levels passed. `spent` is the time of its analysis; none if it was not
  /// analyzed.
  void count(std::span<const float> felt, std::optional<GstClockTime> spent);
  /// Transfer full.
  GstStructure *to_structure() const;
};
