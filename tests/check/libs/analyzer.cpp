// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/analyzer.h"

#include "i420_frame.h"
#include "support/saliency_oracle.h"
#include "support/tolerance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

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

std::vector<oracle::LabImage>
pyramid_of(const Frame &frame)
{
  std::vector<oracle::LabImage> levels{ oracle::lab_image(frame.view()) };
  while (levels.back()[0].values.size() > 1)
    levels.push_back(oracle::pyr_down(levels.back()));
  return levels;
}

/// Mean over the last `window` of maps that last `duration` each. What lies before the first map
/// counts as that map if `filled`, else it is left out.
Image
window_mean(const std::vector<Image> &maps, double window, double duration, bool filled)
{
  Image sum(maps[0].width, maps[0].height);
  double length = 0;
  for (int k = 0; k * duration < window; ++k) {
    const int i = static_cast<int>(maps.size()) - 1 - k;
    if (i < 0 && !filled)
      break;
    const double share = std::min(duration, window - k * duration);
    length += share;
    for (std::size_t p = 0; p < sum.values.size(); ++p)
      sum.values[p] += share * maps[static_cast<std::size_t>(std::max(i, 0))].values[p];
  }
  for (double &v : sum.values)
    v /= length;
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

GST_START_TEST(test_paper_profile)
{
  // 64×48 has levels 0 to 6, so surrounds 7 and 8 are limited to 6.
  const std::vector<saliency::LevelPair> levels{ { 2, 5 }, { 2, 6 }, { 3, 6 },
                                                 { 3, 6 }, { 4, 6 }, { 4, 6 } };
  Analyzer analyzer(Profile::paper());
  Analyzer still(Profile::paper());
  std::vector<Image> maps;
  for (int i = 0; i < 30; ++i) {
    const Frame frame = film(64, 48, i);
    maps.push_back(oracle::spatial_saliency(pyramid_of(frame), levels, levels, 2, 1, true, false));
    Image st(maps[0].width, maps[0].height);
    for (const auto &[center, surround] :
         { std::pair{ 1, 8 }, { 1, 16 }, { 2, 16 }, { 2, 32 }, { 4, 32 }, { 4, 64 } }) {
      const Image c = window_mean(maps, center, 1, false);
      const Image s = window_mean(maps, surround, 1, false);
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
GST_END_TEST;

GST_START_TEST(test_tuned_profile)
{
  // At a width of 64 the pair's levels are 0 and 1 and the map's level is 2. Nothing is decimated
  // before the conversion to L*a*b*.
  // What stands still or goes on is left in, too (habituation.cpp judges that).
  Profile profile = Profile::tuned();
  profile.habituation_after = std::numeric_limits<double>::infinity();
  profile.transition_guard = false;
  profile.noise_gain = 0;
  for (const double rate : { 30.0, 25.0, 60.0 }) {
    Analyzer analyzer(profile);
    Analyzer still(profile);
    std::vector<Image> maps;
    double highest = 0;
    for (int i = 0; i < 40; ++i) {
      const Frame frame = film(64, 48, i);
      maps.push_back(oracle::spatial_saliency(pyramid_of(frame), { { 0, 1 } }, { { 1, 2 } }, 2, 2,
                                              false, true));
      Image st(maps[0].width, maps[0].height);
      for (const auto &[center, surround] :
           { std::pair{ 1, 8 }, { 2, 16 }, { 4, 32 }, { 8, 64 } }) {
        const Image c = window_mean(maps, center, 30 / rate, true);
        const Image s = window_mean(maps, surround, 30 / rate, true);
        const double light = oracle::illumination(c, s);
        for (std::size_t p = 0; p < st.values.size(); ++p)
          st.values[p] += std::max(0.0, c.values[p] - light * s.values[p]) / 4;
      }
      st = oracle::without_background(st, 8, 0.75, 0, 3);

      const Time time(std::llround(1e9 * i / rate));
      const Time duration = Time(std::llround(1e9 * (i + 1) / rate)) - time;
      fail_unless_at_most(
          oracle::difference(still.analyze(frame.view(), time, duration, false).map, maps.back()),
          0.02);
      const auto &result = analyzer.analyze(frame.view(), time, duration);
      const double e = oracle::difference(result.map, st);
      fail_unless(e <= 0.02, "frame %d at %g fps: %g", i, rate, e);
      fail_unless_near(result.peak, st.maximum(), 0.02);
      highest = std::max(highest, result.peak);
    }
    fail_unless(highest > 2, "the ball is not salient: peak %g", highest);
  }
}
GST_END_TEST;

GST_START_TEST(test_exact_and_decimated_agree)
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
GST_END_TEST;

GST_START_TEST(test_same_film_at_any_rate)
{
  // A ball appears at 1 s and moves at 2 s and 2.5 s. At equal times the maps are equal at any
  // rate. At 29.97 fps and at a variable rate, frames end only near those times.
  const auto at = [](double second) {
    Frame frame = textured(48, 36);
    if (second >= 1)
      frame.disc(second < 2 ? 10 : second < 2.5 ? 24 : 38, 18, 6, { 210, 90, 200 });
    return frame;
  };
  const auto run = [&](const std::vector<double> &borders) {
    Analyzer analyzer(Profile::tuned());
    std::vector<cv::Mat> maps;
    for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
      const Time time(std::llround(borders[i] * 1e9));
      const Time duration = Time(std::llround(borders[i + 1] * 1e9)) - time;
      const cv::Mat map = analyzer.analyze(at(borders[i] + 1e-6).view(), time, duration).map;
      const double half_seconds = borders[i + 1] * 2;
      if (std::abs(half_seconds - std::round(half_seconds)) < 1e-6)
        maps.push_back(map.clone());
    }
    return maps;
  };
  const auto regular = [](int rate) {
    std::vector<double> borders;
    for (int i = 0; i <= 4 * rate; ++i)
      borders.push_back(static_cast<double>(i) / rate);
    return borders;
  };
  std::vector<double> variable{ 0.0 };
  while (variable.back() < 4)
    for (const double length : { 0.02, 0.04, 0.1, 0.001, 0.039, 0.05 })
      variable.push_back(variable.back() + length);

  const auto reference = run(regular(30));
  ck_assert_uint_eq(reference.size(), 8);
  double highest = 0;
  for (const auto &borders : { regular(24), regular(26), regular(48), regular(50), regular(60),
                               regular(120), variable }) {
    const auto maps = run(borders);
    ck_assert_uint_ge(maps.size(), 8);
    for (std::size_t i = 0; i < 8; ++i) {
      fail_unless_at_most(cv::norm(maps[i], reference[i], cv::NORM_INF), 1e-3);
      highest = std::max(highest, cv::norm(maps[i], cv::NORM_INF));
    }
  }
  fail_unless(highest > 0.6, "no event to compare: peak %g", highest);
}
GST_END_TEST;

GST_START_TEST(test_no_ghost)
{
  // A ball that has been still for three seconds vanishes.
  for (const bool onset : { true, false }) {
    Profile profile = Profile::tuned();
    profile.temporal_sign
        = onset ? saliency::TemporalSign::onset : saliency::TemporalSign::absolute;
    Analyzer analyzer(profile);
    for (int i = 0; i < 120; ++i) {
      Frame frame(64, 48);
      if (i < 100)
        frame.disc(32, 24, 8, { 210, 90, 200 });
      const double p = peak(analyzer, frame, i * kSecond / 30);
      if (i < 100 || onset)
        fail_unless(p == 0, "frame %d: %g", i, p);
      else
        fail_unless(p > 0.6, "frame %d: %g", i, p);
    }
  }
}
GST_END_TEST;

GST_START_TEST(test_no_burst)
{
  // After a start, a reset, a step back in time, a repeated time, a change of size or a gap, the
  // first frame is not salient. The next one that shows something new is.
  const Frame gray = textured(64, 48);
  const Frame ball = film(64, 48, 10);
  const Frame other(80, 60);
  const Time frame = kSecond / 30;
  for (const auto &profile : { Profile::tuned(), Profile::paper() }) {
    const bool seconds = profile.time_base == saliency::TimeBase::seconds;
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
    fail_unless((peak(analyzer, gray, hole + frame) == 0)
                == seconds); // longer than the longest window
    fail_unless(peak(analyzer, ball, hole + 2 * frame + 63 * frame) > 0); // shorter
  }
}
GST_END_TEST;

GST_START_TEST(test_extreme_times)
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
    fail_unless(i % 2 == 1 ? p > 0.6 : p < 0.6);
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
GST_END_TEST;

GST_START_TEST(test_sizes)
{
  for (const auto &profile : { Profile::tuned(), Profile::paper() }) {
    Analyzer analyzer(profile);
    for (const auto &[width, height] : { std::pair{ 1, 1 },
                                         { 1, 2 },
                                         { 2, 1 },
                                         { 1, 301 },
                                         { 701, 1 },
                                         { 3, 3 },
                                         { 17, 5 },
                                         { 321, 241 },
                                         { 640, 3 } })
      for (int i = 0; i < 3; ++i)
        for (const bool temporal : { false, true }) {
          Frame frame(width, height, static_cast<std::uint8_t>(16 + 60 * i));
          frame.disc(width / 3.0, height / 2.0, 1 + width / 8.0, { 200, 60, 220 });
          const auto &result
              = analyzer.analyze(frame.view(), i * kSecond / 30 + (temporal ? Time(1) : Time(0)),
                                 kSecond / 30, temporal);
          fail_unless(!result.map.empty() && result.map.type() == CV_32FC1);
          fail_unless(cv::checkRange(result.map, true, nullptr, 0, 1e4)); // finite and ≥ 0
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
GST_END_TEST;

GST_START_TEST(test_picture)
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
GST_END_TEST;

GST_START_TEST(test_invalid)
{
  const Frame ball = film(64, 48, 10);
  const auto with = [](auto change) {
    Profile profile = Profile::tuned();
    change(profile);
    return !fault_of(profile).empty();
  };
  fail_if(with([](Profile &) {}));
  fail_if(fault_of(Profile{}).empty());
  fail_unless(with([](Profile &p) { p.levels.clear(); }));
  fail_unless(with([](Profile &p) { p.windows.clear(); }));
  fail_unless(with([](Profile &p) { p.levels = { { -1, 2 } }; }));
  fail_unless(with([](Profile &p) { p.levels = { { 3, 2 } }; }));
  fail_unless(with([](Profile &p) { p.windows = { { 0, 2 } }; }));
  fail_unless(with([](Profile &p) { p.saliency_level = -1; }));
  fail_unless(with([](Profile &p) { p.chroma_octaves = -1; }));
  fail_unless(with([](Profile &p) { p.camera_dilation = -1; }));
  fail_unless(with([](Profile &p) { p.camera_rim = -1; }));
  fail_unless(with([](Profile &p) { p.background_quantile = 1.01; }));
  fail_unless(with([](Profile &p) { p.background_quantile = NAN; }));
  fail_unless(with([](Profile &p) { p.background_limit = NAN; }));
  fail_unless(with([](Profile &p) { p.camera_margin = -1; }));
  fail_unless(with([](Profile &p) { p.cut_share = NAN; }));
  fail_unless(with([](Profile &p) { p.time_base = saliency::TimeBase::frames; }));
  // Levels in any order are valid.
  for (const int level : { 0, 1, 2, 6 }) {
    Profile profile = Profile::tuned();
    profile.saliency_level = level;
    Analyzer fine(profile);
    fail_unless(fault_of(profile).empty());
    fine.analyze(ball.view(), Time(0), kSecond / 30);
  }
}
GST_END_TEST;

GST_START_TEST(test_spatial_has_no_history)
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
GST_END_TEST;

GST_START_TEST(test_cut)
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
    fail_unless((result.peak > 0.6) == (i >= 10), "frame %d: %g", i, result.peak);
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
  profile.background_gain = 0;
  Analyzer uncut(profile);
  uncut.analyze(gray.view(), Time(0), Time(0));
  const auto &next = uncut.analyze(ball.view(), kSecond / 30, Time(0));
  fail_if(next.cut);
  fail_unless(next.peak > 0.6);
}
GST_END_TEST;

GST_START_TEST(test_pan)
{
  // A camera pans over a surface and rests. Only a ball that appears and stays at its place in the
  // picture is salient. Without motion compensation, the surface is salient, too.
  Profile unfollowed = Profile::tuned();
  unfollowed.camera_motion = false;
  unfollowed.background_gain = 0;
  Profile followed = Profile::tuned();
  followed.background_gain = 0;
  Analyzer tuned(Profile::tuned());
  Analyzer with(followed);
  Analyzer without(unfollowed);
  double highest = 0;
  double highest_with = 0;
  double highest_without = 0;
  double panned = 0;
  for (int i = 0; i < 150; ++i) {
    const bool ball = i == 40 || i == 41;
    const Frame f = surface(1.4 * std::clamp(i - 10, 0, 50), ball);
    const Time time = i * kSecond / 30;
    const auto &result = tuned.analyze(f.view(), time, Time(0));
    fail_if(result.cut);
    panned += result.motion.tx;
    ck_assert_int_eq(tuned.picture().size().width, 4 * result.map.cols);
    if (i <= 10 || i >= 145)
      fail_if(result.camera_moves, "frame %d", i);
    if (i >= 14 && i < 120)
      fail_unless(result.camera_moves, "frame %d", i);
    if (ball) {
      cv::Point at;
      cv::minMaxLoc(result.map, nullptr, nullptr, nullptr, &at);
      fail_unless(result.peak > 1, "the ball is not salient: peak %g", result.peak);
      fail_unless_at_most(std::hypot(at.x - 110 / 4.0, at.y - 62 / 4.0), 4);
    }
    if (i >= 40)
      continue;
    highest = std::max(highest, result.peak);
    highest_with = std::max(highest_with, with.analyze(f.view(), time, Time(0)).peak);
    highest_without = std::max(highest_without, without.analyze(f.view(), time, Time(0)).peak);
  }
  fail_unless_near(panned, -1.4 * 50 / 4, 0.5); // to the left, in samples
  fail_unless(highest_without > 0.5, "the pan is not salient without compensation: peak %g",
              highest_without);
  fail_unless_at_most(highest_with, highest_without / 5);
  fail_unless_at_most(highest, highest_with);
}
GST_END_TEST;

GST_START_TEST(test_pan_at_any_level)
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
GST_END_TEST;

/// A fast pan at a low frame rate changes as much as a cut, but the shot goes on.
GST_START_TEST(test_fast_pan_is_no_cut)
{
  Profile unfollowed = Profile::tuned();
  unfollowed.camera_motion = false;
  Analyzer with(Profile::tuned());
  Analyzer without(unfollowed);
  for (int i = 0; i < 12; ++i) {
    const Frame f = surface(10.0 * std::max(i - 3, 0), false);
    const Time time = i * kSecond / 8;
    fail_if(with.analyze(f.view(), time, kSecond / 8).cut, "frame %d", i);
    fail_unless(without.analyze(f.view(), time, kSecond / 8).cut == (i > 3), "frame %d", i);
  }
}
GST_END_TEST;

static Suite *
analyzer_suite(void)
{
  Suite *suite = suite_create("analyzer");
  TCase *tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_test(tc, test_paper_profile);
  tcase_add_test(tc, test_tuned_profile);
  tcase_add_test(tc, test_exact_and_decimated_agree);
  tcase_add_test(tc, test_same_film_at_any_rate);
  tcase_add_test(tc, test_no_ghost);
  tcase_add_test(tc, test_no_burst);
  tcase_add_test(tc, test_extreme_times);
  tcase_add_test(tc, test_sizes);
  tcase_add_test(tc, test_picture);
  tcase_add_test(tc, test_invalid);
  tcase_add_test(tc, test_spatial_has_no_history);
  tcase_add_test(tc, test_cut);
  tcase_add_test(tc, test_pan);
  tcase_add_test(tc, test_pan_at_any_level);
  tcase_add_test(tc, test_fast_pan_is_no_cut);
  return suite;
}

GST_CHECK_MAIN(analyzer);
