// SPDX-License-Identifier: LGPL-2.1-or-later
#include "people/people.h"

#include "fake_faces.h"
#include "i420_frame.h"
#include "support/tolerance.h"

#include "support/check_tests.h"

#include <opencv2/core.hpp>

#include <cmath>

using people::Effort;
using people::People;
using people::Time;

namespace {

constexpr int kStep = 16; // pixels between samples of the map
constexpr int kFine = 4;  // and of the picture
const cv::Size kFrame(320, 192);
const cv::Rect kFace(200, 60, 64, 64);

/// Frames at 30 Hz, as an analyzer gives them. Skin-colored, so that single pictures have faces.
class Film
{
public:
  explicit Film(bool temporal = true)
      : people(faces.make(), Effort::fast, temporal), frame(kFrame.width, kFrame.height)
  {
    std::ranges::fill(frame.planes[1], 108);
    std::ranges::fill(frame.planes[2], 152);
    found.map = cv::Mat(kFrame / kStep, CV_32FC1, cv::Scalar(0));
    found.picture
        = { 0.5 - 0.5 / kStep, 0.5 - 0.5 / kStep, static_cast<double>(kFrame.width) / kStep,
            static_cast<double>(kFrame.height) / kStep };
    picture.planes[0] = cv::Mat(kFrame / kFine, CV_32FC1, cv::Scalar(50));
    faces.set({ kFace });
  }

  const cv::Mat &next()
  {
    cv::minMaxLoc(found.map, nullptr, &found.peak);
    const Time time(std::chrono::nanoseconds(std::chrono::seconds(number++)) / 30);
    return people.raise({ found, picture, frame.view(), known }, time);
  }
  const cv::Mat &play(int frames)
  {
    const cv::Mat *map = &found.map;
    while (frames-- > 0)
      map = &next();
    return *map;
  }
  /// A mouth that opens and closes, and noise all over.
  const cv::Mat &talk(int frames, double by, double noise = 0)
  {
    const cv::Mat *map = &found.map;
    for (int i = 0; i < frames; ++i) {
      cv::Mat &lightness = picture.planes[0];
      lightness.setTo(50);
      const cv::Rect mouth(kFace.x / kFine + 5, kFace.y / kFine + 11, 6, 3);
      lightness(mouth).setTo(i / 3 % 2 ? 50 - by : 50);
      cv::Mat grain(lightness.size(), CV_32FC1);
      generator.fill(grain, cv::RNG::NORMAL, 0, noise);
      lightness += grain;
      map = &next();
    }
    return *map;
  }
  std::size_t count() const
  {
    return people.faces().size();
  }

  FakeFaces faces;
  People people;
  oracle::Frame frame;
  saliency::Saliency found;
  saliency::LabImage picture;
  std::vector<cv::Rect2d> known;
  int number = 0;
  cv::RNG generator{ 7 };
};

cv::Point
strongest(const cv::Mat &map)
{
  cv::Point most;
  cv::minMaxLoc(map, nullptr, nullptr, nullptr, &most);
  return most;
}

double
peak(const cv::Mat &map)
{
  double most = 0;
  cv::minMaxLoc(map, nullptr, &most);
  return most;
}

/// f at a sample of the map, by definition; `width` is σ in widths of kFace.
double
face_at(const saliency::Saliency &found, cv::Point sample, double width)
{
  const double x = (sample.x + 0.5 - found.picture.x) * kStep - (kFace.x + kFace.width / 2.0);
  const double y = (sample.y + 0.5 - found.picture.y) * kStep - (kFace.y + kFace.height / 2.0);
  return std::exp(-(x * x + y * y) / (2 * std::pow(width * kFace.width, 2)));
}

} // namespace

/// A face counts once its second picture is due: 2 × 0.2 s, whatever the speed of the machine.
CHECK_TEST(test_counts_after_two_looks)
{
  Film film;
  film.play(12);
  ck_assert_uint_eq(film.count(), 0);
  film.next();
  ck_assert_uint_eq(film.count(), 1);
  fail_unless(film.people.faces()[0] == cv::Rect2d(kFace));
  // From then on a look each 0.8 s.
  const std::size_t looks = film.faces.seen().size();
  film.play(96);
  ck_assert_uint_eq(film.faces.seen().size(), looks + 4);
  ck_assert_int_eq(film.people.statistics().faces, 1);
}

/// A picture in which nothing is new has no new face. What is new is looked at at once.
CHECK_TEST(test_nothing_new)
{
  Film film;
  film.faces.set({});
  film.play(30);
  film.found.unchanged = true;
  film.play(1);
  const std::size_t looks = film.faces.seen().size();
  film.play(60);
  ck_assert_uint_eq(film.faces.seen().size(), looks);
  film.found.unchanged = false;
  film.faces.set({ kFace });
  film.play(13);
  ck_assert_uint_eq(film.count(), 1);
}

/// Faces go 3 s after the last hit, at a cut at once, and what is found in the last shot does not
/// count in the next one.
CHECK_TEST(test_faces_go)
{
  Film film;
  film.play(30);
  ck_assert_uint_eq(film.count(), 1);
  film.faces.set({});
  film.play(60);
  ck_assert_uint_eq(film.count(), 1);
  film.play(45);
  ck_assert_uint_eq(film.count(), 0);

  film.faces.set({ kFace });
  film.play(30);
  ck_assert_uint_eq(film.count(), 1);
  film.faces.set({});
  film.found.cut = true;
  film.next();
  ck_assert_uint_eq(film.count(), 0);
  film.found.cut = false;
  film.play(30);
  ck_assert_uint_eq(film.count(), 0);
}

/// A map with nothing in it stays, bit for bit, with a face at rest; the same face is felt where it
/// is once it talks, also in noise, and not while the camera moves.
CHECK_TEST(test_talk)
{
  for (const double noise : { 0.0, 1.0 }) {
    Film film;
    fail_unless(peak(film.talk(60, 0, noise)) == 0);
    ck_assert_uint_eq(film.count(), 1);
    const cv::Mat &talking = film.talk(30, 15, noise);
    const cv::Point most = strongest(talking);
    fail_unless(peak(talking) > 0.8, "%g", peak(talking)); // the floor of films
    fail_unless(cv::Rect(kFace).contains(most * kStep), "at %d, %d", most.x, most.y);
    fail_unless(talking.at<float>(2, 2) == 0);
    film.found.camera_moves = true;
    fail_unless(peak(film.talk(30, 15, noise)) == 0);
  }
}

/// A face that fades to black and in again does not talk.
CHECK_TEST(test_fade)
{
  Film film;
  film.play(30);
  ck_assert_uint_eq(film.count(), 1);
  const cv::Rect face(kFace.x / kFine, kFace.y / kFine, kFace.width / kFine, kFace.height / kFine);
  for (const double step : { -2.0, 0.0, 2.0 })
    for (int i = 0; i < (step == 0 ? 60 : 20); ++i) {
      cv::Mat seen = film.picture.planes[0](face);
      seen += step;
      fail_unless_at_most(peak(film.next()), 0.01);
    }
}

/// Talk without a face is nothing, and without faces the map is the same object.
CHECK_TEST(test_no_face)
{
  Film film;
  film.faces.set({});
  const cv::Mat &map = film.talk(60, 15, 1);
  fail_unless(&map == &film.found.map);
}

/// In films f has σ = 0.45 of the box. Where an event outside is up to 31 times as strong, the face
/// wins; the maximum stays.
CHECK_TEST(test_events_in_faces_win)
{
  Film film;
  film.play(30);
  cv::Mat &map = film.found.map;
  map.at<float>(2, 2) = 3;
  const cv::Point center(14, 6);
  map.at<float>(center) = 0.4F;
  const cv::Mat &raised = film.next();
  fail_unless(strongest(raised) == center);
  fail_unless_near(peak(raised), 3, 1e-5);
  const double f = face_at(film.found, center, 0.45);
  fail_unless_near(raised.at<float>(center) / raised.at<float>(2, 2), (0.4 + 30 * f * 0.27) / 3,
                   1e-3);
}

/// Single pictures have no second look: their faces count at once if they look like skin.
CHECK_TEST(test_single_pictures)
{
  Film film(false);
  film.found.map.setTo(2);
  const cv::Mat &raised = film.next();
  ck_assert_uint_eq(film.count(), 1);
  fail_unless_near(peak(raised), 2, 1e-5);
  const cv::Point most = strongest(raised);
  fail_unless(kFace.contains(most * kStep));
  fail_unless_near(raised.at<float>(most) / raised.at<float>(0, 0),
                   1 + 9 * face_at(film.found, most, 0.315), 1e-3);

  film.people.reset();
  std::ranges::fill(film.frame.planes[2], 100); // green
  film.next();
  ck_assert_uint_eq(film.count(), 0);

  // Skin itself: twice as much, with a* and b* of the map's size.
  const cv::Size size = film.found.map.size();
  film.picture.planes
      = { cv::Mat(size, CV_32FC1, cv::Scalar(60)), cv::Mat(size, CV_32FC1, cv::Scalar(0)),
          cv::Mat(size, CV_32FC1, cv::Scalar(-50)) };
  film.picture.planes[1].at<float>(3, 4) = 14;
  film.picture.planes[2].at<float>(3, 4) = 20;
  const cv::Mat &skin = film.next();
  fail_unless_near(skin.at<float>(3, 4), 2, 1e-5);
  fail_unless_near(skin.at<float>(8, 8), 1, 0.01);
}

/// What others found takes the place of detections.
CHECK_TEST(test_known_people)
{
  Film film;
  film.known = { cv::Rect2d(20, 20, 40, 40) };
  film.play(60);
  ck_assert_int_eq(film.faces.made(), 0);
  ck_assert_uint_eq(film.count(), 1);
  fail_unless(film.people.faces()[0] == film.known[0]);
  film.known.clear();
  film.play(85);
  ck_assert_int_eq(film.faces.made(), 0);
  ck_assert_uint_eq(film.count(), 1);
  film.play(60);
  ck_assert_int_eq(film.faces.made(), 1);
  ck_assert_uint_eq(film.count(), 1);
  fail_unless(film.people.faces()[0] == cv::Rect2d(kFace));
}

/// A detector that does not come to an end holds nobody up; its faces count later.
CHECK_TEST(test_never_blocks)
{
  Film film;
  film.people.wait(false);
  film.faces.hold();
  film.play(90);
  film.faces.wait_until_begun(1);
  ck_assert_uint_eq(film.faces.seen().size(), 1);
  ck_assert_uint_eq(film.count(), 0);
  film.faces.release();
  film.people.wait(true);
  film.play(8);
  ck_assert_uint_eq(film.count(), 1);
}

/// A face that is found in a pan is where the camera has taken it meanwhile, and follows.
CHECK_TEST(test_pan)
{
  Film film;
  film.found.motion = { 1, 0, 2.0 / kStep, 0 }; // two pixels a frame
  film.faces.find_brightest({ 40, 40 });
  double x = 0;
  for (int i = 0; i < 60; ++i) {
    x = 100 + 2 * film.number;
    film.frame = oracle::Frame(kFrame.width, kFrame.height);
    film.frame.disc(x, 100, 3, { 235, 128, 128 });
    film.next();
  }
  ck_assert_uint_eq(film.count(), 1);
  fail_unless_near(film.people.faces()[0].x + 20, x, 6);
  fail_unless_near(film.people.faces()[0].y + 20, 100, 3);
}

/// Time that goes back, another size, tiny frames.
CHECK_TEST(test_resets)
{
  Film film;
  film.play(30);
  ck_assert_uint_eq(film.count(), 1);
  film.number = 0;
  film.next();
  ck_assert_uint_eq(film.count(), 0);
  film.play(30);
  ck_assert_uint_eq(film.count(), 1);
  film.frame = oracle::Frame(1, 1);
  film.found.map = cv::Mat(1, 1, CV_32FC1, cv::Scalar(1));
  film.found.picture = { 0, 0, 1, 1 };
  film.picture.planes[0] = cv::Mat(1, 1, CV_32FC1, cv::Scalar(50));
  film.faces.set({});
  for (int i = 0; i < 30; ++i)
    fail_unless(peak(film.next()) == 1);
}

CHECK_MAIN(people)
