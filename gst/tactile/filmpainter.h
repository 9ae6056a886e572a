// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactile/synthetic_film.h"

#include <gst/video/video.h>

#include <memory>
#include <optional>
#include <vector>

/// Paints the frames of a synthetic film in one video format of 8-bit samples.
class FilmPainter
{
public:
  /// None if memory for a frame is out.
  static std::optional<FilmPainter> make(const GstVideoInfo &info);

  /// Background, balls in their order and, unless null, sensor noise. `frame` has the painter's
  /// format. False if memory is out.
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
  std::unique_ptr<GstBuffer, Unref> background_; ///< copying is much cheaper than drawing
};

/// Adds the ground truth of a ball: a GstVideoRegionOfInterestMeta `tactile-target` of the pixels
/// that it touches.
void add_target(GstBuffer *buffer, const GstVideoInfo &info, const tactile::Ball &ball);
