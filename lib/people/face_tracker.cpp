// SPDX-License-Identifier: LGPL-2.1-or-later
#include "people/face_tracker.h"

#include <algorithm>
#include <cmath>

namespace people {

namespace {

cv::Point2d
middle(const cv::Rect2d &box)
{
  return (box.tl() + box.br()) / 2;
}

cv::Rect2d
around(const cv::Point2d &middle, const cv::Size2d &size)
{
  return { middle - cv::Point2d(size.width, size.height) / 2, size };
}

/// How far apart two boxes are, in their sizes: 1 and more cannot be the same face.
double
distance(const cv::Rect2d &one, const cv::Rect2d &other)
{
  constexpr double kFarthest = 0.6;   // of the mean width
  constexpr double kMostGrowth = 1.7; // as a factor
  const double width = (one.width + other.width) / 2;
  const double apart = cv::norm(middle(one) - middle(other)) / (kFarthest * width);
  const double grown = std::abs(std::log(one.width / other.width)) / std::log(kMostGrowth);
  return std::max(apart, grown);
}

} // namespace

cv::Rect2d
moved(const cv::Rect2d &box, const saliency::Similarity &motion)
{
  const cv::Point2d center = middle(box);
  return around({ motion.x(center.x, center.y), motion.y(center.x, center.y) },
                box.size() * std::hypot(motion.a, motion.b));
}

void
FaceTracker::advance(double elapsed, const saliency::Similarity &camera)
{
  for (Face &face : faces_) {
    face.box = moved(face.box + face.velocity * elapsed, camera);
    face.unseen += elapsed;
  }
  std::erase_if(faces_, [](const Face &face) { return face.unseen >= kHold; });
}

void
FaceTracker::update(std::span<const cv::Rect2d> hits, double age)
{
  // Weights of a hit: boxes of detectors jitter.
  constexpr double kPlace = 0.75;
  constexpr double kVelocity = 0.5;
  constexpr double kShortest = 0.05; // between two hits, in seconds

  std::vector<cv::Rect2d> left(hits.begin(), hits.end());
  for (Face &face : faces_) {
    const auto gap = [&face, age](const cv::Rect2d &hit) {
      return distance(face.box, hit + face.velocity * age);
    };
    const auto nearest = std::ranges::min_element(left, {}, gap);
    if (nearest == left.end() || gap(*nearest) >= 1) {
      face.velocity *= 0.5;
      face.hits = face.confirmed() ? face.hits : 0;
      continue;
    }
    const cv::Point2d off = middle(*nearest) + face.velocity * age - middle(face.box);
    const double growth = kPlace * (nearest->width / face.box.width - 1) + 1;
    face.velocity += off * (kVelocity / std::max(face.unseen, kShortest));
    face.box = around(middle(face.box) + off * kPlace, face.box.size() * growth);
    face.hits++;
    face.unseen = 0;
    left.erase(nearest);
  }
  std::erase_if(faces_, [](const Face &face) { return face.hits == 0; });
  for (const cv::Rect2d &hit : left)
    faces_.push_back({ .box = hit });
}

void
FaceTracker::replace(std::span<const cv::Rect2d> boxes)
{
  faces_.clear();
  for (const cv::Rect2d &box : boxes)
    faces_.push_back({ .box = box, .hits = 2 });
}

} // namespace people
