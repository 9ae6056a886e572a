// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

#include <filesystem>
#include <mutex>
#include <vector>

/// A few frames of the film with their tactile maps beneath, for a picture of the whole.
class Strip
{
public:
  /// Frames are taken at the middle of `count` equal parts of the film; of one without a known
  /// length, every ten seconds. Of one that ends before the first of these, the latest frame that
  /// was looked at.
  Strip(GstClockTime film_duration, int count);
  ~Strip();
  Strip(const Strip &) = delete;
  Strip &operator=(const Strip &) = delete;

  /// Looks at a frame that passes by (streaming thread); keeps a copy if its turn has come.
  void offer(GstBuffer *buffer, GstCaps *caps, GstClockTime stream_time);

  /// Writes what was kept as PNG. False if there is nothing, or no encoder.
  bool write(const std::filesystem::path &path);

private:
  std::mutex mutex_;
  GstClockTime step_;
  GstClockTime next_;
  GstClockTime next_early_ = 0; ///< until the first turn has come
  bool early_ = false;          ///< what is kept is from before the first turn
  int count_;
  std::vector<GstSample *> samples_;
};
