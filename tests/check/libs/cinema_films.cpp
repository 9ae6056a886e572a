// SPDX-License-Identifier: LGPL-2.1-or-later
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <functional>
#include <memory>
#include <vector>

#include "quality/cinema_light.h"
#include "quality/cinema_scores.h"
#include "quality/cinema_talk.h"
#include "quality/cinema_textures.h"
#include "quality/cinema_titles.h"
#include "quality/cinema_travel.h"
#include "quality/pictures.h"
#include "support/felt.h"
#include "support/tolerance.h"

#include "support/check_tests.h"

using namespace std::chrono_literals;
using quality::CinemaFilm;
using quality::CinemaJudge;
using quality::CinemaScores;
using quality::Expected;
using quality::Light;
using quality::Mover;
using quality::Stir;
using quality::Time;
using quality::Title;
using quality::Travel;
using quality::Verdict;

namespace {

const cv::Size kSize{ 320, 180 };
constexpr Time kFrame = Time(1s) / 30;

using Maker = std::function<std::unique_ptr<CinemaFilm>(std::uint64_t seed)>;

const std::vector<cv::Mat> &
pictures()
{
  static const std::vector<cv::Mat> all{ quality::dead_leaves({ 640, 480 }, 1),
                                         quality::dead_leaves({ 640, 480 }, 2) };
  return all;
}

Maker
travel(Travel travel, Mover mover, std::vector<double> depths = {})
{
  return [=](std::uint64_t seed) {
    return quality::travelling_film({ travel, mover, kSize, seed, depths }, pictures());
  };
}

Maker
light(Light light)
{
  return [=](std::uint64_t seed) {
    return quality::light_film(light, pictures(), kSize, seed);
  };
}

Maker
titles(Title title, bool over_picture)
{
  return [=](std::uint64_t seed) {
    return quality::title_film(title, over_picture ? pictures()[0] : cv::Mat(), kSize, seed);
  };
}

Maker
stir(Stir stir)
{
  return [=](std::uint64_t seed) {
    return quality::stirring_film(stir, pictures()[0], kSize, seed);
  };
}

Maker
talk(bool listener)
{
  return [=](std::uint64_t seed) {
    return quality::talking_film(listener, pictures()[0], kSize, seed);
  };
}

bool
same(const cv::Mat &a, const cv::Mat &b)
{
  return cv::norm(a, b, cv::NORM_INF) == 0;
}

} // namespace

CHECK_TEST(test_seeds)
{
  // The same seed gives the same film, even if other frames were drawn before; another one does
  // not.
  for (const Maker &make :
       { travel(Travel::truck, Mover::across), travel(Travel::dolly, Mover::none),
         travel(Travel::walk, Mover::heading), travel(Travel::pan, Mover::appears),
         light(Light::dissolve), light(Light::fire), light(Light::fast_pan), light(Light::zoom),
         titles(Title::fades, false), titles(Title::credits, true), stir(Stir::rain),
         stir(Stir::leaves), stir(Stir::water), stir(Stir::crowd), stir(Stir::grain),
         talk(true) }) {
    const auto one = make(3);
    const auto again = make(3);
    const auto other = make(4);
    cv::Mat a;
    cv::Mat b;
    one->draw(1s, a);
    for (const Time time : { 2500ms, 5000ms }) {
      const Expected expected = one->draw(time, a);
      const Expected repeated = again->draw(time, b);
      fail_unless(a.size() == kSize && a.type() == CV_8UC3);
      fail_unless(same(a, b));
      fail_unless(expected.verdict == repeated.verdict && expected.cells == repeated.cells);
    }
    other->draw(5s, b);
    fail_unless(!same(a, b));
  }
}

CHECK_TEST(test_parallax)
{
  // Of two walls, one three times as far moves a third as much.
  double moved[2] = {};
  for (int i = 0; i < 2; ++i) {
    const auto film = travel(Travel::truck, Mover::none, { i == 0 ? 4.0 : 12.0 })(3);
    cv::Mat gray[2];
    for (int at = 0; at < 2; ++at) {
      cv::Mat bgr;
      film->draw(3s + at * 100ms, bgr);
      cv::cvtColor(bgr, bgr, cv::COLOR_BGR2GRAY);
      bgr.convertTo(gray[at], CV_64F);
    }
    cv::Mat window;
    cv::createHanningWindow(window, kSize, CV_64F);
    const cv::Point2d by = cv::phaseCorrelate(gray[0], gray[1], window);
    fail_unless_near(by.y, 0, 0.1);
    moved[i] = std::abs(by.x);
  }
  fail_unless(moved[0] > 3, "%.2f pixels", moved[0]);
  fail_unless_near(moved[0] / moved[1], 3, 0.2);
}

CHECK_TEST(test_things_appear)
{
  // What differs from the film without a thing is where the thing is said to be.
  for (const Travel how : { Travel::truck, Travel::dolly, Travel::walk, Travel::pan })
    for (const std::uint64_t seed : { 1, 2 }) {
      const auto with = travel(how, Mover::appears)(seed);
      const auto without = travel(how, Mover::none)(seed);
      cv::Mat a;
      cv::Mat b;
      int differing = 0;
      for (Time time{ 0 }; time < 4s; time += 3 * kFrame) {
        const Expected expected = with->draw(time, a);
        const Expected nothing = without->draw(time, b);
        fail_unless(nothing.verdict == Verdict::quiet && nothing.cells.none()
                    && nothing.events == 0);
        if (expected.cells.none()) {
          fail_unless(same(a, b) && expected.verdict == Verdict::quiet);
          continue;
        }
        cv::Mat difference;
        cv::absdiff(a, b, difference);
        cv::cvtColor(difference, difference, cv::COLOR_BGR2GRAY);
        double all = 0;
        double inside = 0;
        for (int y = 0; y < a.rows; ++y)
          for (int x = 0; x < a.cols; ++x) {
            const int cell = y * 3 / a.rows * 3 + x * 3 / a.cols;
            all += difference.at<uchar>(y, x);
            inside
                += expected.cells[static_cast<std::size_t>(cell)] ? difference.at<uchar>(y, x) : 0;
          }
        differing += all > 0;
        fail_unless(inside >= 0.8 * all, "travel %d, seed %d, %.2f s: %.0f of %.0f",
                    static_cast<int>(how), static_cast<int>(seed),
                    std::chrono::duration<double>(time).count(), inside, all);
      }
      fail_unless(differing > 3);
    }
}

CHECK_TEST(test_people_walk)
{
  // Three people in each film, all of whom are to be found in most; felt only if they walk.
  int events = 0;
  for (const Travel how : { Travel::truck, Travel::dolly, Travel::walk, Travel::pan })
    for (const std::uint64_t seed : { 1, 2 }) {
      const auto film = travel(how, Mover::across)(seed);
      cv::Mat picture;
      Expected expected;
      int frames = 0;
      for (Time time{ 0 }; time < quality::kCinemaLength; time += 3 * kFrame) {
        expected = film->draw(time, picture);
        fail_unless((expected.verdict == Verdict::quiet) == expected.cells.none());
        fail_unless(time >= 2s || expected.verdict == Verdict::quiet);
        frames += expected.verdict == Verdict::felt;
      }
      fail_unless(expected.events <= 3);
      fail_unless(frames > 20 && frames <= 3 * 23, "%d frames", frames);
      events += expected.events;
    }
  fail_unless(events >= 18, "%d events", events);
}

CHECK_TEST(test_quiet)
{
  // Changes of light are never felt, textures not after 4 s.
  cv::Mat picture;
  for (const Light what : { Light::dissolve, Light::fade, Light::exposure, Light::flash,
                            Light::glow, Light::fast_pan, Light::zoom }) {
    const auto film = light(what)(1);
    cv::Mat first;
    bool changes = false;
    for (Time time{ 0 }; time < quality::kCinemaLength;
         time += (what == Light::flash ? 1 : 3) * kFrame) {
      const Expected expected = film->draw(time, picture);
      if (first.empty())
        picture.copyTo(first);
      changes |= cv::norm(first, picture, cv::NORM_L1) > 2 * 3 * kSize.area();
      fail_unless(expected.verdict == Verdict::quiet && expected.cells.none()
                  && expected.events == 0);
    }
    fail_unless(changes, "light %d", static_cast<int>(what));
  }
  for (const Stir what : { Stir::rain, Stir::leaves, Stir::water, Stir::crowd, Stir::grain }) {
    const auto film = stir(what)(1);
    fail_unless(film->draw(3900ms, picture).verdict == Verdict::allowed);
    cv::Mat before;
    picture.copyTo(before);
    fail_unless(film->draw(4s, picture).verdict == Verdict::quiet);
    fail_unless(!same(before, picture));
  }
}

CHECK_TEST(test_titles)
{
  // Where a title is quiet, nothing changes. Credits scroll on.
  cv::Mat last;
  cv::Mat picture;
  for (const Title title : { Title::fades, Title::pops })
    for (const bool over_picture : { false, true }) {
      const auto film = titles(title, over_picture)(1);
      bool was_quiet = false;
      int shown = 0;
      for (Time time{ 0 }; time < quality::kCinemaLength; time += kFrame) {
        const bool quiet = film->draw(time, picture).verdict == Verdict::quiet;
        fail_unless(!quiet || !was_quiet || same(picture, last));
        was_quiet = quiet;
        shown += quiet && cv::countNonZero(picture.reshape(1) > 235) > 100;
        picture.copyTo(last);
      }
      fail_unless(shown > 60, "a title stands in %d frames", shown);
    }
  const auto credits = titles(Title::credits, false)(1);
  credits->draw(8s, last);
  fail_unless(credits->draw(8s + kFrame, picture).verdict == Verdict::quiet);
  fail_unless(!same(picture, last));
}

CHECK_TEST(test_fire_and_talk)
{
  // Most of what changes from frame to frame is in the cells that are to be felt.
  for (const Maker &make : { light(Light::fire), talk(false), talk(true) }) {
    const auto film = make(1);
    cv::Mat last;
    cv::Mat picture;
    double all = 0;
    double inside = 0;
    for (Time time = 1900ms; time < 5s; time += kFrame) {
      const Expected expected = film->draw(time, picture);
      if (!last.empty() && expected.verdict != Verdict::quiet) {
        cv::Mat difference;
        cv::absdiff(picture, last, difference);
        cv::transform(difference, difference, cv::Matx13f(1, 1, 1));
        for (int y = 0; y < picture.rows; ++y)
          for (int x = 0; x < picture.cols; ++x) {
            const double change = difference.at<uchar>(y, x) > 8;
            const int cell = y * 3 / picture.rows * 3 + x * 3 / picture.cols;
            all += change;
            inside += expected.cells[static_cast<std::size_t>(cell)] ? change : 0;
          }
      }
      picture.copyTo(last);
    }
    fail_unless(all > 1000 && inside > 0.5 * all, "%.0f of %.0f", inside, all);
  }
}

CHECK_TEST(test_judge)
{
  CinemaJudge judge;
  const auto expected = [](Verdict verdict, unsigned cells, int events) {
    return Expected{ verdict, cells, events };
  };
  const Time step = 250ms;
  // A phantom of two frames.
  judge.frame(expected(Verdict::quiet, 0, 0), 0ms, step, felt(-1));
  judge.frame(expected(Verdict::quiet, 0, 0), 250ms, step, felt(2));
  judge.frame(expected(Verdict::quiet, 0, 0), 500ms, step, felt(2));
  // Found at once, in one of two seconds; the third has not passed.
  for (int i = 0; i < 9; ++i)
    judge.frame(expected(Verdict::felt, 1, 1), 1s + i * step, step,
                felt(i == 0   ? 0
                     : i == 5 ? 4
                              : -1));
  // Found too late.
  judge.frame(expected(Verdict::allowed, 2, 2), 4s, step, felt(-1));
  judge.frame(expected(Verdict::allowed, 2, 2), 4750ms, step, felt(1));
  judge.frame(quality::anything(), 5s, step, felt(7));
  const CinemaScores &s = judge.scores();
  fail_unless_near(s.phantoms.count, 3, 0);
  fail_unless_near(s.phantoms.sum, 2, 0);
  fail_unless_near(s.longest, 0.5, 1e-9);
  fail_unless_near(s.right.count, 5, 0);
  fail_unless_near(s.right.sum, 2, 0);
  fail_unless_near(s.found.count, 2, 0);
  fail_unless_near(s.found.sum, 1, 0);
  fail_unless_near(s.told.count, 2, 0);
  fail_unless_near(s.told.sum, 1, 0);
}

CHECK_MAIN_AFTER(cinema_films, 120, cv::setNumThreads(1))
