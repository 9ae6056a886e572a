// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/synthetic_film.h"

#include <gst/video/video.h>

#include <memory>
#include <optional>
#include <vector>

/// Paints the pictures of a synthetic film in one video format of 8-bit samples.
class FilmPainter
{
public:
  /// None if there is no memory for a picture.
  static std::optional<FilmPainter> make(const GstVideoInfo &info);

  /// The background, the balls in their order and, unless it is null, sensor noise. `frame` has the
  /// painter's format. False if there is no memory for it.
  bool paint(GstVideoFrame *frame, const std::vector<tactile::Ball> &balls,
             const tactile::SensorNoise *noise, tactile::Time time) const;

private:
  FilmPainter() = default;

  struct Unref
  {
    void operator()(GstBuffer *buffer) const
    {
      gst_buffer_unref(buffer);
    }
  };

  GstVideoInfo info_;
  std::unique_ptr<GstBuffer, Unref> background_; ///< to copy from, far cheaper than to draw
};

/// Tells the truth about a ball: a GstVideoRegionOfInterestMeta `tactile-target` of the pixels that
/// it touches.
void add_target(GstBuffer *buffer, const GstVideoInfo &info, const tactile::Ball &ball);
