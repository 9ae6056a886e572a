// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/film.h"
#include "film/pipeline.h"

#include <functional>
#include <string>

/// A frame as JPEG; empty: it cannot be converted.
std::string jpeg_of(GstSample *sample);

/// The launch line of a film's frames as small RGB pictures, up to an appsink `eye`.
std::string small_frames(const Film &film, int width, int height);

/// A few key frames from all over a film, within seconds, before it is decoded. Main context's
/// thread.
class Glance
{
public:
  struct Events
  {
    /// The picture of the last key frame before a moment.
    std::function<void(gint64 ms, std::string jpeg)> taken;
    std::function<void()> done;
  };

  /// At `every` ms of the film's `duration`.
  Glance(const Film &film, int width, int height, gint64 every, Events events);
  ~Glance();
  Glance(const Glance &) = delete;
  Glance &operator=(const Glance &) = delete;

private:
  gboolean on_message(GstMessage *message);
  void stop();

  const Events events_;
  const gint64 every_;
  const GstClockTime start_; ///< stream time of the film's 0:00
  const GstClockTime duration_;
  gint64 at_ = 0; ///< ms
  guint watch_ = 0;
  guint limit_ = 0;
  Pipeline pipeline_;
};
