// SPDX-License-Identifier: LGPL-2.1-or-later
#include "people/face_tracker.h"

#include "support/tolerance.h"

#include "support/check_tests.h"

#include <array>

using people::FaceTracker;
using saliency::Similarity;

namespace {

const cv::Rect2d kBox(100, 80, 40, 40);

using Boxes = std::vector<cv::Rect2d>;

double
middle_x(const FaceTracker::Face &face)
{
  return face.box.x + face.box.width / 2;
}

} // namespace

/// The second hit in a row confirms a face; a miss drops one that is not confirmed.
CHECK_TEST(test_confirmed_by_two_hits)
{
  FaceTracker tracker;
  tracker.update(Boxes{ kBox }, 0);
  ck_assert_uint_eq(tracker.faces().size(), 1);
  fail_if(tracker.faces()[0].confirmed());
  tracker.update(Boxes{ kBox + cv::Point2d(9, -9) }, 0); // boxes jitter
  ck_assert_uint_eq(tracker.faces().size(), 1);
  fail_unless(tracker.faces()[0].confirmed());

  tracker.reset();
  tracker.update(Boxes{ kBox }, 0);
  tracker.update({}, 0);
  fail_unless(tracker.faces().empty());
  tracker.update(Boxes{ kBox }, 0);
  fail_if(tracker.faces()[0].confirmed());
  // Neither another place nor another size is the same face.
  for (const cv::Rect2d &other :
       { kBox + cv::Point2d(30, 0), cv::Rect2d(80, 60, 80, 80), cv::Rect2d(110, 90, 20, 20) }) {
    tracker.reset();
    tracker.update(Boxes{ kBox }, 0);
    tracker.update(Boxes{ other }, 0);
    ck_assert_uint_eq(tracker.faces().size(), 1);
    fail_if(tracker.faces()[0].confirmed());
  }
}

CHECK_TEST(test_dropped_after_a_while)
{
  FaceTracker tracker;
  tracker.replace(Boxes{ kBox });
  for (int i = 0; i < 29; ++i) {
    tracker.advance(0.1, {});
    tracker.update({}, 0.2);
    ck_assert_uint_eq(tracker.faces().size(), 1);
    fail_unless(tracker.faces()[0].box == kBox);
  }
  tracker.update(Boxes{ kBox }, 0);
  tracker.advance(FaceTracker::kHold - 0.01, {});
  ck_assert_uint_eq(tracker.faces().size(), 1);
  tracker.advance(0.02, {});
  fail_unless(tracker.faces().empty());
}

/// A pan, a zoom, and both moves one after the other.
CHECK_TEST(test_follows_the_camera)
{
  const Similarity pan{ 1, 0, 7, -3 };
  const Similarity zoom{ 1.5, 0, -60, -40 };
  FaceTracker tracker;
  tracker.replace(Boxes{ kBox });
  tracker.advance(0.03, pan);
  fail_unless(tracker.faces()[0].box == kBox + cv::Point2d(7, -3));
  tracker.advance(0.03, zoom);
  const cv::Rect2d &box = tracker.faces()[0].box;
  fail_unless_near(box.width, 60, 1e-9);
  fail_unless_near(box.x + box.width / 2, 1.5 * 127 - 60, 1e-9);
  fail_unless_near(box.y + box.height / 2, 1.5 * 97 - 40, 1e-9);
  fail_unless(box == people::moved(kBox, zoom * pan));
}

/// A face at constant velocity, found every 0.4 s in a picture of 0.2 s ago, is where it is between
/// the detections, too; in a camera that pans its own velocity is the rest.
CHECK_TEST(test_follows_a_moving_face)
{
  for (const double pan : { 0.0, 50.0 }) {
    constexpr double kVelocity = 30;
    FaceTracker tracker;
    const auto box_at = [=](double time) {
      return kBox + cv::Point2d((kVelocity + pan) * time, 0);
    };
    tracker.replace(Boxes{ kBox });
    for (int i = 1; i <= 120; ++i) {
      const double time = i / 30.0;
      tracker.advance(1 / 30.0, { 1, 0, pan / 30, 0 });
      if (i % 12 == 0) // the hit has followed the camera since
        tracker.update(Boxes{ box_at(time - 0.2) + cv::Point2d(0.2 * pan, 0) }, 0.2);
      ck_assert_uint_eq(tracker.faces().size(), 1);
      const double off = middle_x(tracker.faces()[0]) - (box_at(time).x + 20);
      fail_unless_at_most(std::abs(off), time < 3 ? 16 : 1);
    }
    fail_unless_near(tracker.faces()[0].velocity.x, kVelocity, 1);
  }
}

/// Neighbors keep their boxes, whatever the order of hits.
CHECK_TEST(test_several_faces)
{
  const cv::Rect2d right = kBox + cv::Point2d(45, 0);
  FaceTracker tracker;
  tracker.update(Boxes{ kBox, right }, 0);
  tracker.update(Boxes{ right, kBox }, 0);
  ck_assert_uint_eq(tracker.faces().size(), 2);
  fail_unless(tracker.faces()[0].box == kBox);
  fail_unless(tracker.faces()[1].box == right);
  // One of them is missed, and a third one comes.
  tracker.update(Boxes{ right, kBox + cv::Point2d(0, 90) }, 0);
  ck_assert_uint_eq(tracker.faces().size(), 3);
  fail_unless(tracker.faces()[0].confirmed() && tracker.faces()[1].confirmed());
  fail_if(tracker.faces()[2].confirmed());
}

CHECK_MAIN(face_tracker)
