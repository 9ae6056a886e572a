// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frame/lab_image.h"
#include "people/detector.h"

#include <opencv2/core/types.hpp>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <pthread.h>

namespace people {

/// A box in which a detector found a face.
struct Hit
{
  cv::Rect2d box;  ///< in pixels of the frame
  double skin = 0; ///< mean likeness to skin, in [0, 1]
};

/// Detects faces on a thread of its own, which starts with the first picture. The next picture
/// replaces a waiting one. All functions are for one other thread.
class DetectionThread
{
public:
  struct Statistics
  {
    int detections = 0;
    std::chrono::nanoseconds busy{}; ///< processor time of all of them
  };

  /// `width`: the larger side of pictures that the detector gets.
  DetectionThread(MakeDetector make, int width);
  /// Waits for the end of the detection that runs.
  ~DetectionThread();
  DetectionThread(const DetectionThread &) = delete;
  DetectionThread &operator=(const DetectionThread &) = delete;

  /// The level of a frame's pyramid that offer() needs: 0.8 to 1.6 times `width`, or the frame.
  int level(cv::Size frame) const;

  /// Copies a picture, the frame's level `level`.
  void offer(const saliency::FixedLabImage &picture, int level);

  /// The faces in the latest picture, once: none while it is not done, unless `wait` is set.
  std::optional<std::vector<Hit>> take(bool wait);

  /// The fault that ended detection; empty: none.
  std::string failure();

  Statistics statistics();

private:
  struct Picture
  {
    saliency::FixedLabImage lab;
    int level = 0;
  };

  void run();
  std::string detect();
  std::vector<Hit> find(Detector &detector, const Picture &picture) const;

  MakeDetector make_;
  int width_;
  bool started_ = false; ///< used by the caller only, like thread_
  pthread_t thread_{};
  std::mutex mutex_;
  std::condition_variable offered_;
  std::condition_variable done_;
  Picture waiting_; ///< from here on under mutex_
  bool is_waiting_ = false;
  bool end_ = false;
  std::optional<std::vector<Hit>> hits_;
  std::string failure_;
  Statistics statistics_;
};

} // namespace people
