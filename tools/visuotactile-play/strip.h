// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

#include <filesystem>
#include <mutex>
#include <vector>

/// A picture of a few frames of the film, with their tactile maps beneath.
class Strip
{
public:
  /// Keeps the frames at the middle of `count` equal parts of the film, or one every ten seconds if
  /// its length is unknown. A film that ends before the first of these has its last frame kept, to
  /// half a second.
  Strip(GstClockTime film_duration, int count);
  ~Strip();
  Strip(const Strip &) = delete;
  Strip &operator=(const Strip &) = delete;

  /// On the streaming thread: copies the frame if its turn has come.
  void offer(GstBuffer *buffer, GstCaps *caps, GstClockTime stream_time);

  /// Writes a PNG. False if no frame was kept, or no encoder is installed.
  bool write(const std::filesystem::path &path);

private:
  std::mutex mutex_;
  GstClockTime step_;
  GstClockTime next_;
  GstClockTime next_early_ = 0; ///< before the first turn
  bool early_ = false;          ///< the kept frame is from before the first turn
  int count_;
  std::vector<GstSample *> samples_;
};
