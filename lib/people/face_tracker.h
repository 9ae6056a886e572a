// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "saliency/similarity.h"

#include <opencv2/core/types.hpp>

#include <span>
#include <vector>

namespace people {

/// The box after a motion; turns are ignored.
cv::Rect2d moved(const cv::Rect2d &box, const saliency::Similarity &motion);

/// Follows faces between detections: by the camera's motion, and by their own velocity from one hit
/// to the next. A face counts once it was found twice in a row, and is dropped after kHold without
/// a hit. Boxes are in pixels of the frame, times in seconds.
class FaceTracker
{
public:
  static constexpr double kHold = 3;

  struct Face
  {
    cv::Rect2d box;
    cv::Point2d velocity{}; ///< of its own, a second
    int hits = 1;
    double unseen = 0; ///< time since the last hit

    bool confirmed() const
    {
      return hits >= 2;
    }
  };

  /// Advances to the next frame. `camera` maps a point of the last frame to where it is now.
  void advance(double elapsed, const saliency::Similarity &camera);

  /// Adds the result of a detection in the picture of `age` ago. `hits` have followed the camera
  /// since.
  void update(std::span<const cv::Rect2d> hits, double age);

  /// Replaces all faces by these, which are confirmed.
  void replace(std::span<const cv::Rect2d> boxes);

  void reset()
  {
    faces_.clear();
  }

  /// All faces, also those that are not confirmed.
  const std::vector<Face> &faces() const
  {
    return faces_;
  }

private:
  std::vector<Face> faces_;
};

} // namespace people
