// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/analyzer.h"

#include "i420_frame.h"
#include "support/saliency_oracle.h"
#include "support/tolerance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "support/check_tests.h"

using oracle::film;
using oracle::Frame;
using oracle::Image;
using oracle::textured;
using saliency::Analyzer;
using saliency::FrameView;
using saliency::Profile;
using saliency::Time;

namespace {

constexpr Time kSecond = std::chrono::seconds(1);
constexpr double kFloor = 0.8; ///< of the tuned mapping

std::vector<oracle::LabImage>
pyramid_of(const Frame &frame)
{
  std::vector<oracle::LabImage> levels{ oracle::lab_image(frame.view()) };
  while (levels.back()[0].values.size() > 1)
    levels.push_back(oracle::pyr_down(levels.back()));
  return levels;
}

/// Mean over the last `window` maps, or over all there are.
Image
window_mean(const std::vector<Image> &maps, int window)
{
  Image sum(maps[0].width, maps[0].height);
  const std::size_t count = std::min(maps.size(), static_cast<std::size_t>(window));
  for (std::size_t i = maps.size() - count; i < maps.size(); ++i)
    for (std::size_t p = 0; p < sum.values.size(); ++p)
      sum.values[p] += maps[i].values[p] / static_cast<double>(count);
  return sum;
}

double
correlation(const cv::Mat &a, const cv::Mat &b)
{
  cv::Mat da = a - cv::mean(a)[0];
  cv::Mat db = b - cv::mean(b)[0];
  return da.dot(db) / std::sqrt(da.dot(da) * db.dot(db));
}

double
peak(Analyzer &analyzer, const Frame &frame, Time time, Time duration = kSecond / 30)
{
  return analyzer.analyze(frame.view(), time, duration).peak;
}

/// A patterned surface, of which 220 × 124 pixels from `left` on are seen, and a ball in the middle
/// of the picture.
Frame
surface(double left, bool ball)
{
  Frame f(220, 124);
  for (int y = 0; y < f.height; ++y)
    for (int x = 0; x < f.width; ++x) {
      double sum = 120;
      for (int i = 0; i < 8; ++i) {
        const double length = 14 * std::pow(1.35, i);
        sum += 12
               * std::sin(6.2832 / length * ((x + left) * std::cos(2.4 * i) + y * std::sin(2.4 * i))
                          + i * i);
      }
      f.at(0, x, y) = static_cast<std::uint8_t>(std::clamp(std::lround(sum), 16L, 235L));
    }
  if (ball)
    f.disc(110, 62, 13, { 210, 60, 220 });
  return f;
}

} // namespace

CHECK_TEST(test_paper_profile)
{
  // 64×48 has levels 0 to 6, so surrounds 7 and 8 are limited to 6.
  const std::vector<saliency::LevelPair> levels{ { 2, 5 }, { 2, 6 }, { 3, 6 },
                                                 { 3, 6 }, { 4, 6 }, { 4, 6 } };
  Analyzer analyzer(Profile::paper());
  Analyzer still(Profile::paper());
  std::vector<Image> maps;
  for (int i = 0; i < 30; ++i) {
    const Frame frame = film(64, 48, i);
    maps.push_back(oracle::spatial_saliency(pyramid_of(frame), levels, levels, 2, 1, true));
    Image st(maps[0].width, maps[0].height);
    for (const auto &[center, surround] :
         { std::pair{ 1, 8 }, { 1, 16 }, { 2, 16 }, { 2, 32 }, { 4, 32 }, { 4, 64 } }) {
      const Image c = window_mean(maps, center);
      const Image s = window_mean(maps, surround);
      for (std::size_t p = 0; p < st.values.size(); ++p)
        st.values[p] += std::abs(c.values[p] - s.values[p]);
    }
    st = oracle::itti(st);

    // The paper's windows count frames: timestamps do not matter.
    const Time time = i * i * kSecond;
    const auto &spatial = still.analyze(frame.view(), time, kSecond, false);
    fail_unless_at_most(oracle::difference(spatial.map, maps.back()), 5e-3);
    fail_unless_near(spatial.peak, maps.back().maximum(), 5e-3);
    const auto &result = analyzer.analyze(frame.view(), time, kSecond);
    const double e = oracle::difference(result.map, st);
    fail_unless(e <= 5e-3, "frame %d: %g", i, e);
    fail_unless_near(result.peak, st.maximum(), 5e-3);
  }
}

CHECK_TEST(test_tuned_profile)
{
  // At a width of 64 the pair's levels are 0 and 1 and the map's level is 2. Nothing is decimated
  // before the conversion to L*a*b*.
  Analyzer analyzer(Profile::tuned());
  Analyzer still(Profile::tuned());
  double highest = 0;
  for (int i = 0; i < 40; ++i) {
    const Frame frame = film(64, 48, i);
    const Image spatial
        = oracle::spatial_saliency(pyramid_of(frame), { { 0, 1 } }, { { 1, 2 } }, 2, 2, false);
    const Time time = i * kSecond / 30;
    fail_unless_at_most(
        oracle::difference(still.analyze(frame.view(), time, kSecond / 30, false).map, spatial),
        0.02);
    const auto &result = analyzer.analyze(frame.view(), time, kSecond / 30);
    highest = std::max(highest, result.peak);
    fail_unless(result.peak == 0 || result.strength > 0);
  }
  fail_unless(highest > kFloor, "the ball is not salient: peak %g", highest);
}

CHECK_TEST(test_exact_and_decimated_agree)
{
  // Colored shapes with a little noise, too large for converting every pixel to L*a*b*.
  std::mt19937 generator(3);
  const auto random = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(generator);
  };
  for (const auto &[width, height] : { std::pair{ 1000, 700 }, { 1280, 720 }, { 1001, 541 } }) {
    Frame frame(width, height);
    for (int i = 0; i < 40; ++i)
      frame.disc(random(0, width), random(0, height), random(width / 40, width / 6),
                 { random(30, 220), random(80, 170), random(80, 170) });
    for (auto &v : frame.planes[0])
      v = static_cast<std::uint8_t>(v + random(-3, 3));
    Profile profile = Profile::tuned();
    Analyzer fast(profile);
    profile.exact = true;
    Analyzer exact(profile);
    const double c = correlation(fast.analyze(frame.view(), Time(0), Time(0), false).map,
                                 exact.analyze(frame.view(), Time(0), Time(0), false).map);
    fail_unless(c >= 0.999, "%dx%d: %.6f", width, height, c);
    fail_unless(c < 1, "identical maps for %dx%d: nothing was decimated", width, height);
  }
}

CHECK_TEST(test_same_film_at_any_rate)
{
  // A ball that crosses the picture is about as salient at any rate: at 30 fps it is compared with
  // where it was 67 ms ago, at others 80 to 83 ms.
  const auto run = [](const std::vector<double> &borders) {
    Analyzer analyzer(Profile::tuned());
    double sum = 0;
    double length = 0;
    for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
      Frame frame = textured(160, 120);
      frame.disc(20 + 40 * borders[i], 60, 10, { 210, 90, 200 });
      const Time time(std::llround(borders[i] * 1e9));
      const Time duration = Time(std::llround(borders[i + 1] * 1e9)) - time;
      const double peak = analyzer.analyze(frame.view(), time, duration).peak;
      if (borders[i] < 0.5)
        continue;
      sum += peak * (borders[i + 1] - borders[i]);
      length += borders[i + 1] - borders[i];
    }
    return sum / length;
  };
  const auto regular = [](double rate) {
    std::vector<double> borders;
    for (int i = 0; i <= 3 * rate; ++i)
      borders.push_back(i / rate);
    return borders;
  };
  std::vector<double> variable{ 0.0 };
  while (variable.back() < 3)
    for (const double length : { 0.02, 0.04, 0.06, 0.001, 0.039, 0.05 })
      variable.push_back(variable.back() + length);

  const double reference = run(regular(30));
  fail_unless(reference > kFloor, "no event to compare: %g", reference);
  for (const auto &borders : { regular(24), regular(25), regular(29.97), regular(48), regular(50),
                               regular(60), regular(120), variable })
    fail_unless_near(run(borders) / reference, 1, 0.3);
}

CHECK_TEST(test_no_ghost)
{
  // A ball that has been still for three seconds vanishes, and comes back a second later.
  Analyzer analyzer(Profile::tuned());
  for (int i = 0; i < 132; ++i) {
    Frame frame(64, 48);
    if (i < 100 || i >= 130)
      frame.disc(32, 24, 8, { 210, 90, 200 });
    const double p = peak(analyzer, frame, i * kSecond / 30);
    fail_unless(i < 100 ? p == 0 : (p > kFloor) == (i >= 130), "frame %d: %g", i, p);
  }
}

CHECK_TEST(test_no_burst)
{
  // After a start, a reset, a step back in time, a repeated time, a change of size or a gap, the
  // first frame is not salient. The next one that shows something new is.
  const Frame gray = textured(64, 48);
  const Frame ball = film(64, 48, 10);
  const Frame other(80, 60);
  const Time frame = kSecond / 30;
  for (const auto &profile : { Profile::tuned(), Profile::paper() }) {
    const bool seconds = profile.method != saliency::Method::paper;
    Analyzer analyzer(profile);
    const auto starts_anew = [&](const Frame &first, Time time) {
      fail_unless(peak(analyzer, first, time) == 0);
      fail_unless(peak(analyzer, &first == &ball ? gray : ball, time + frame) > 0);
    };
    starts_anew(gray, Time(0));
    analyzer.reset();
    starts_anew(gray, 2 * frame);
    starts_anew(gray, Time(0));                          // a step back
    starts_anew(gray, frame);                            // the same time
    fail_unless(peak(analyzer, other, 10 * frame) == 0); // another size
    starts_anew(gray, 11 * frame);                       // and back
    starts_anew(gray, -100 * kSecond);                   // before zero
    const Time hole = -100 * kSecond + 2 * frame + 64 * frame;
    fail_unless((peak(analyzer, gray, hole + frame) == 0) == seconds);    // longer than two seconds
    fail_unless(peak(analyzer, ball, hole + 2 * frame + 63 * frame) > 0); // shorter
  }
}

CHECK_TEST(test_extreme_times)
{
  const Time first(std::numeric_limits<Time::rep>::min());
  const Time last(std::numeric_limits<Time::rep>::max());
  const Frame gray(64, 48);
  Frame ball = gray;
  ball.disc(32, 24, 8, { 210, 90, 200 });
  Analyzer analyzer(Profile::tuned());
  for (const Time duration : { Time(0), Time(-1), first, last, kSecond }) {
    analyzer.reset();
    for (const Time time : { first, Time(-1), Time(0), Time(1), Time(2), last - Time(1), last }) {
      const auto &result = analyzer.analyze(ball.view(), time, duration);
      fail_unless(cv::checkRange(result.map));
      fail_unless(result.peak == 0); // nothing changes
    }
  }

  // Slides: each is displayed for an hour, and each differs from the last.
  analyzer.reset();
  for (int i = 0; i < 6; ++i) {
    const double p = peak(analyzer, i % 2 == 0 ? gray : ball, i * 3600 * kSecond, 3600 * kSecond);
    fail_unless(i % 2 == 1 ? p > kFloor : p < kFloor, "slide %d: %g", i, p);
  }
  // An unknown duration counts as 1/30 s.
  Analyzer known(Profile::tuned());
  analyzer.reset();
  for (int i = 0; i < 6; ++i) {
    const Frame frame = film(32, 24, 2 * i);
    const Time time = i * kSecond / 30;
    fail_unless_near(peak(analyzer, frame, time, Time(0)),
                     peak(known, frame, time, Time(1'000'000'000 / 30)), 0);
  }
}

CHECK_TEST(test_sizes)
{
  // Two pictures of each size and kind, so that they are compared, one analyzer for all.
  for (const auto &profile : { Profile::tuned(), Profile::paper() }) {
    Analyzer analyzer(profile);
    Time time(0);
    for (const auto &[width, height] : { std::pair{ 1, 1 },
                                         { 1, 2 },
                                         { 2, 1 },
                                         { 1, 301 },
                                         { 701, 1 },
                                         { 3, 3 },
                                         { 17, 5 },
                                         { 321, 241 },
                                         { 640, 3 } })
      for (const bool temporal : { false, true })
        for (int i = 0; i < 4; ++i) {
          time += kSecond / 30;
          Frame frame(width, height, static_cast<std::uint8_t>(16 + 60 * i));
          frame.disc(width / 3.0 + i, height / 2.0, 1 + width / 8.0, { 200, 60, 220 });
          const auto &result = analyzer.analyze(frame.view(), time, kSecond / 30, temporal);
          fail_unless(!result.map.empty() && result.map.type() == CV_32FC1);
          fail_unless(cv::checkRange(result.map, true, nullptr, 0, 1e4)); // finite and ≥ 0
          fail_unless(std::isfinite(result.strength) && result.strength >= 0);
          double highest = 0;
          cv::minMaxLoc(result.map, nullptr, &highest);
          fail_unless_near(result.peak, highest, 0);
        }
  }
  // The map is at the profile's level. For a width of 321, level 1 is nearest to 220 pixels, so the
  // map is at level 3.
  Analyzer analyzer(Profile::tuned());
  const cv::Mat map = analyzer.analyze(Frame(321, 241).view(), Time(0), Time(0)).map;
  ck_assert_int_eq(map.cols, 41);
  ck_assert_int_eq(map.rows, 31);
}

CHECK_TEST(test_picture)
{
  // A dot is at the same place in the map and in the picture. Sample coordinates (the center of
  // sample i is at i + ½) map linearly from the picture's edges. The map's center of mass locates
  // the dot.
  Profile profile = Profile::tuned();
  Analyzer analyzer(profile);
  for (const auto &[x, y] : { std::pair{ 200, 150 }, { 331, 222 }, { 448, 128 }, { 101, 307 } }) {
    Frame frame(640, 480);
    frame.disc(x, y, 30, { 220, 128, 128 });
    const auto &result = analyzer.analyze(frame.view(), Time(0), Time(0), false);
    double mass = 0;
    double at_x = 0;
    double at_y = 0;
    for (int j = 0; j < result.map.rows; ++j)
      for (int i = 0; i < result.map.cols; ++i) {
        const auto v = static_cast<double>(result.map.at<float>(j, i));
        mass += v;
        at_x += v * (i + 0.5);
        at_y += v * (j + 0.5);
      }
    const auto &picture = result.picture;
    // The center of pixel x is at x + ½ of the picture's 640. Tolerance: a twentieth of a sample,
    // which is 16 pixels wide.
    fail_unless_near((at_x / mass - picture.x) / picture.width * 640, x + 0.5, 0.8);
    fail_unless_near((at_y / mass - picture.y) / picture.height * 480, y + 0.5, 0.8);
  }
}

CHECK_TEST(test_invalid)
{
  const Frame ball = film(64, 48, 10);
  const auto with = [](auto change) {
    Profile profile = Profile::tuned();
    change(profile);
    return !fault_of(profile).empty();
  };
  fail_if(with([](Profile &) {}));
  fail_unless(with([](Profile &p) { p.levels = { -1, 2 }; }));
  fail_unless(with([](Profile &p) { p.levels = { 3, 2 }; }));
  fail_unless(with([](Profile &p) { p.saliency_level = -1; }));
  fail_unless(with([](Profile &p) { p.chroma_octaves = -1; }));
  fail_unless(with([](Profile &p) { p.chroma_weight = -1; }));
  fail_unless(with([](Profile &p) { p.cut_share = NAN; }));
  // Levels in any order are valid.
  for (const int level : { 0, 1, 2, 6 }) {
    Profile profile = Profile::tuned();
    profile.saliency_level = level;
    Analyzer fine(profile);
    fail_unless(fault_of(profile).empty());
    fine.analyze(ball.view(), Time(0), kSecond / 30);
  }
}

CHECK_TEST(test_spatial_has_no_history)
{
  // Frames before one without `temporal` do not affect the frames after it.
  Analyzer resumed(Profile::tuned());
  Analyzer started(Profile::tuned());
  for (int i = 0; i < 16; ++i) {
    const Frame frame = film(64, 48, i);
    const Time time = i * kSecond / 30;
    const auto &a = resumed.analyze(frame.view(), time, kSecond / 30, i != 8);
    fail_if(i == 8 && (a.cut || a.camera_moves));
    if (i > 8)
      fail_unless_near(
          cv::norm(a.map, started.analyze(frame.view(), time, kSecond / 30).map, cv::NORM_INF), 0,
          0);
  }
  // Moving an analyzer moves its history.
  Analyzer moved = std::move(resumed);
  const Frame frame = film(64, 48, 16);
  fail_unless_near(peak(moved, frame, 16 * kSecond / 30), peak(started, frame, 16 * kSecond / 30),
                   0);
  ck_assert_int_eq(moved.profile().reference_width, Profile::tuned().reference_width);
}

CHECK_TEST(test_cut)
{
  // The first frame of a new shot is silent, and what then appears in it is salient. A frame of
  // another size is silent, too, but not a cut.
  const Frame gray = textured(160, 120);
  Frame other = gray;
  for (auto &v : other.planes[0])
    v = static_cast<std::uint8_t>(255 - v / 2);
  Frame ball = other;
  ball.disc(80, 60, 12, { 60, 90, 200 });
  Analyzer analyzer(Profile::tuned());
  for (int i = 0; i < 12; ++i) {
    const auto &result = analyzer.analyze((i < 5    ? gray
                                           : i < 10 ? other
                                                    : ball)
                                              .view(),
                                          i * kSecond / 30, Time(0));
    fail_unless(result.cut == (i == 5), "frame %d", i);
    fail_if(result.camera_moves);
    fail_unless((result.peak > kFloor) == (i >= 10), "frame %d: %g", i, result.peak);
  }
  const auto &result = analyzer.analyze(Frame(80, 60, 20).view(), kSecond, Time(0));
  fail_if(result.cut);
  fail_unless_near(result.peak, 0, 0);

  // With a share of 1 nothing is a cut. A frame after a reset is none either.
  Profile profile = Profile::tuned();
  analyzer.reset();
  fail_if(analyzer.analyze(gray.view(), Time(0), Time(0)).cut);
  analyzer.reset();
  fail_if(analyzer.analyze(other.view(), kSecond, Time(0)).cut);
  profile.cut_share = 1;
  Analyzer uncut(profile);
  uncut.analyze(gray.view(), Time(0), Time(0));
  const auto &next = uncut.analyze(ball.view(), kSecond / 30, Time(0));
  fail_if(next.cut);
  fail_unless(next.peak > kFloor);
}

CHECK_TEST(test_pan)
{
  // A camera pans over a surface and rests. Only a ball that appears and stays at its place in the
  // picture is salient.
  Analyzer analyzer(Profile::tuned());
  double panned = 0;
  for (int i = 0; i < 150; ++i) {
    const bool ball = i == 40 || i == 41;
    const Frame f = surface(1.4 * std::clamp(i - 10, 0, 50), ball);
    const auto &result = analyzer.analyze(f.view(), i * kSecond / 30, Time(0));
    fail_if(result.cut);
    panned += result.motion.tx;
    ck_assert_int_eq(analyzer.picture().size().width, 4 * result.map.cols);
    if (i <= 10 || i >= 80)
      fail_if(result.camera_moves, "frame %d", i);
    if (i >= 14 && i < 60)
      fail_unless(result.camera_moves, "frame %d", i);
    if (ball) {
      cv::Point at;
      cv::minMaxLoc(result.map, nullptr, nullptr, nullptr, &at);
      fail_unless(result.peak > kFloor, "the ball is not salient: peak %g", result.peak);
      fail_unless_at_most(std::hypot(at.x - 110 / 4.0, at.y - 62 / 4.0), 4);
    }
    if (i < 40 || i > 60)
      fail_unless(result.peak < kFloor, "frame %d: %g", i, result.peak);
  }
  fail_unless_near(panned, -1.4 * 50 / 4, 0.5); // to the left, in samples
}

CHECK_TEST(test_pan_at_any_level)
{
  // The camera is followed at a level finer than those whose chroma has contrast.
  for (int level = 2; level <= 5; ++level) {
    Profile profile = Profile::tuned();
    profile.saliency_level = level;
    Analyzer analyzer(profile);
    bool moved = false;
    for (int i = 0; i < 20; ++i)
      moved |= analyzer.analyze(surface(1.4 * i, false).view(), i * kSecond / 30, Time(0))
                   .camera_moves;
    fail_unless(moved, "level %d", level);
  }
}

/// A fast pan at a low frame rate changes as much as a cut, but the shot goes on.
CHECK_TEST(test_fast_pan_is_no_cut)
{
  Analyzer analyzer(Profile::tuned());
  for (int i = 0; i < 12; ++i) {
    const Frame f = surface(10.0 * std::max(i - 3, 0), false);
    fail_if(analyzer.analyze(f.view(), i * kSecond / 8, kSecond / 8).cut, "frame %d", i);
  }
  // Another place is one.
  const Frame other = surface(1000, false);
  fail_unless(analyzer.analyze(other.view(), 12 * kSecond / 8, kSecond / 8).cut);
}

CHECK_MAIN(analyzer)
