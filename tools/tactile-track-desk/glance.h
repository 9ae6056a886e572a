// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/film.h"
#include "film/pipeline.h"

#include <functional>
#include <string>
#include <vector>

/// A frame as JPEG; empty: it cannot be converted.
std::string jpeg_of(GstSample *sample);

/// Continues a launch line of frames to small RGB pictures in an appsink `eye`.
std::string small_pictures(int width, int height);

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

  /// At multiples of `every` ms: the halves of the film, then their halves, and so on.
  Glance(const Film &film, int width, int height, gint64 every, Events events);
  ~Glance();
  Glance(const Glance &) = delete;
  Glance &operator=(const Glance &) = delete;

private:
  gboolean on_message(GstMessage *message);
  void stop();

  const Events events_;
  const gint64 start_;        ///< stream time of the film's 0:00
  std::vector<gint64> times_; ///< ms; the next one last
  guint watch_ = 0;
  guint limit_ = 0;
  Pipeline pipeline_;
};
