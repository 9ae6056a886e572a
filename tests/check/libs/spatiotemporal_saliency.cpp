// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/spatiotemporal_saliency.h"

#include "saliency/dilation.h"
#include "support/saliency_oracle.h"
#include "support/tolerance.h"

#include <algorithm>
#include <cmath>

using oracle::Image;
using saliency::HistoryStart;
using saliency::Normalization;
using saliency::Profile;
using saliency::Similarity;
using saliency::SpatiotemporalSaliency;
using saliency::TemporalPyramid;
using saliency::TemporalSign;

namespace {

/// ST of a sequence of maps by its definition, one frame each.
Image
expected(const Profile &profile, const std::vector<Image> &maps)
{
  const auto mean = [&](int window) {
    Image sum(maps[0].width, maps[0].height);
    for (int k = 0; k < window; ++k) {
      // The first map counts as having been there forever.
      const auto i = static_cast<std::size_t>(std::max(0, static_cast<int>(maps.size()) - 1 - k));
      for (std::size_t p = 0; p < sum.values.size(); ++p)
        sum.values[p] += maps[i].values[p] / window;
    }
    return sum;
  };
  Image saliency(maps[0].width, maps[0].height);
  for (const auto &pair : profile.windows) {
    const Image center = mean(pair.center);
    const Image surround = mean(pair.surround);
    for (std::size_t p = 0; p < saliency.values.size(); ++p) {
      const double d = center.values[p] - surround.values[p];
      saliency.values[p]
          += (profile.temporal_sign == TemporalSign::absolute ? std::abs(d) : std::max(0.0, d))
             / (profile.temporal_mean ? static_cast<double>(profile.windows.size()) : 1);
    }
  }
  return profile.temporal_normalization == Normalization::itti ? oracle::itti(saliency) : saliency;
}

Image
to_image(const cv::Mat &map)
{
  Image image(map.cols, map.rows);
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x)
      image(x, y) = static_cast<double>(map.at<float>(y, x));
  return image;
}

/// The maximum of the samples up to `reach` away.
Image
dilated(const Image &map, int reach)
{
  Image result = map;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      for (int j = std::max(0, y - reach); j <= std::min(map.height - 1, y + reach); ++j)
        for (int i = std::max(0, x - reach); i <= std::min(map.width - 1, x + reach); ++i)
          result(x, y) = std::max(result(x, y), map(i, j));
  return result;
}

/// ST by its definition, from the means that the history gives.
Image
expected(const Profile &profile, TemporalPyramid &history)
{
  const auto mean = [&](int window) {
    std::vector<cv::Mat> maps;
    history.means({ &window, 1 }, maps);
    return to_image(maps[0]);
  };
  const bool moved = history.moved();
  Image saliency;
  for (const auto &pair : profile.windows) {
    const Image center = mean(pair.center);
    Image surround = mean(pair.surround);
    const double light = profile.illumination_guard ? oracle::illumination(center, surround) : 1;
    if (moved)
      surround = dilated(surround, profile.camera_dilation);
    saliency.width = center.width;
    saliency.height = center.height;
    saliency.values.resize(center.values.size());
    for (std::size_t p = 0; p < saliency.values.size(); ++p) {
      const double d
          = center.values[p] - light * (moved ? profile.camera_margin : 1) * surround.values[p];
      saliency.values[p]
          += (profile.temporal_sign == TemporalSign::absolute ? std::abs(d) : std::max(0.0, d))
             / (profile.temporal_mean ? static_cast<double>(profile.windows.size()) : 1);
    }
  }
  const int rim = profile.camera_rim;
  const bool rimmed = moved && saliency.width > 2 * rim && saliency.height > 2 * rim;
  if (rimmed)
    for (int y = 0; y < saliency.height; ++y)
      for (int x = 0; x < saliency.width; ++x)
        if (std::min({ x, y, saliency.width - 1 - x, saliency.height - 1 - y }) < rim)
          saliency(x, y) = 0;
  if (profile.background_gain > 0)
    saliency = oracle::without_background(saliency, profile.background_gain,
                                          profile.background_quantile, rimmed ? rim : 0);
  const int seen = rimmed ? (saliency.width - 2 * rim) * (saliency.height - 2 * rim)
                          : saliency.width * saliency.height;
  if (moved && profile.background_gain > 0 && seen >= 64)
    for (double &value : saliency.values)
      value = std::max(0.0, value - profile.camera_background);
  return saliency;
}

/// ST of a film of a single pixel.
std::vector<double>
course(TemporalSign sign, const std::vector<double> &values)
{
  Profile profile = Profile::tuned();
  profile.temporal_sign = sign;
  profile.illumination_guard = false; // a single pixel is the whole map
  profile.background_gain = 0;
  TemporalPyramid history(64, HistoryStart::filled);
  SpatiotemporalSaliency saliency(profile);
  std::vector<double> result;
  for (const double value : values) {
    history.push(oracle::to_mat(Image(1, 1, value)), 1, 1);
    result.push_back(static_cast<double>(saliency.compute(history).at<float>(0)));
  }
  return result;
}

} // namespace

GST_START_TEST(test_brute_force)
{
  for (const auto sign : { TemporalSign::absolute, TemporalSign::onset })
    for (const bool mean : { false, true })
      for (const auto normalization : { Normalization::none, Normalization::itti }) {
        Profile profile;
        profile.windows = { { 1, 8 }, { 1, 16 }, { 2, 16 }, { 8, 64 }, { 16, 4 } };
        profile.temporal_sign = sign;
        profile.temporal_mean = mean;
        profile.temporal_normalization = normalization;
        TemporalPyramid history(64, HistoryStart::filled);
        SpatiotemporalSaliency saliency(profile);
        std::vector<Image> maps;
        for (unsigned i = 0; i < 90; ++i) {
          maps.push_back(oracle::random_image(7, 6, 0, 60, i));
          history.push(oracle::to_mat(maps.back()), 1, 1);
          fail_unless_at_most(
              oracle::difference(saliency.compute(history), expected(profile, maps)), 1e-4);
        }
      }
}
GST_END_TEST;

GST_START_TEST(test_step)
{
  // A pixel that steps from 0 to 80. In closed form, after k frames T_w is 80 min(1, k/w).
  std::vector<double> film(10, 0.0);
  film.insert(film.end(), 80, 80.0);
  const auto st = course(TemporalSign::onset, film);
  for (int i = 0; i < 90; ++i) {
    const int k = std::max(0, i - 9);
    double sum = 0;
    for (const int c : { 1, 2, 4, 8 })
      sum += 80 * (std::min(1.0, k / (1.0 * c)) - std::min(1.0, k / (8.0 * c)));
    fail_unless_near(st[static_cast<std::size_t>(i)], sum / 4, 1e-4);
  }
  fail_unless_near(st[9], 0, 0);
  fail_unless_near(st[10], 80 * (7.0 / 8 + 7.0 / 16 + 7.0 / 32 + 7.0 / 64) / 4, 1e-4); // at once
  fail_unless_near(st[89], 0, 0);                                                      // settled
}
GST_END_TEST;

GST_START_TEST(test_ghost)
{
  // A ball that has long been there vanishes: no response with onset, a ghost of 64 frames with the
  // absolute difference.
  std::vector<double> film(100, 80.0);
  film.insert(film.end(), 100, 0.0);
  const auto onset = course(TemporalSign::onset, film);
  const auto absolute = course(TemporalSign::absolute, film);
  for (std::size_t i = 0; i < film.size(); ++i) {
    fail_unless_near(onset[i], 0, 0);
    if (i >= 100 && i < 163)
      fail_unless(absolute[i] > 0.1);
    else
      fail_unless_near(absolute[i], 0, 0);
  }
}
GST_END_TEST;

GST_START_TEST(test_camera_and_background)
{
  // Maps of all sizes, also with no samples within the rim. A camera that rests, then moves.
  unsigned seed = 0;
  for (const auto sign : { TemporalSign::absolute, TemporalSign::onset })
    for (const int dilation : { 0, 1, 2 })
      for (const int rim : { 0, 1, 2 })
        for (const double gain : { 0.0, 0.5, 8.0 })
          for (const auto &[width, height] :
               { std::pair{ 1, 1 }, { 2, 3 }, { 4, 5 }, { 5, 4 }, { 5, 5 }, { 3, 9 }, { 13, 8 } }) {
            Profile profile;
            profile.windows = { { 1, 4 }, { 2, 8 } };
            profile.temporal_sign = sign;
            profile.camera_dilation = dilation;
            profile.camera_margin = 1.15;
            profile.camera_rim = rim;
            profile.background_gain = gain;
            profile.camera_background = 1.5 * dilation;
            profile.background_quantile = rim == 0 ? 0.75 : rim == 1 ? 0 : 1;
            profile.illumination_guard = dilation != 1;
            TemporalPyramid history(8, HistoryStart::filled);
            SpatiotemporalSaliency saliency(profile);
            for (int i = 0; i < 14; ++i) {
              const Similarity pose{ 1, 0, i < 4 ? 0 : 0.4 * i, 0 };
              history.push(oracle::to_mat(oracle::random_image(width, height, 0, 20, ++seed)), 1, 1,
                           pose);
              fail_unless(history.moved() == (i >= 4));
              const double e
                  = oracle::difference(saliency.compute(history), expected(profile, history));
              fail_unless(e <= 1e-3, "%dx%d, dilation %d, rim %d, gain %g, frame %d: %g", width,
                          height, dilation, rim, gain, i, e);
            }
          }
}
GST_END_TEST;

GST_START_TEST(test_illumination)
{
  // All contrast triples, as when a light is turned on: no response, except for the 0.05 in the
  // ratio. Where it rises sixfold, the excess over triple remains. If only a part rises, that part
  // responds in full.
  Profile profile;
  profile.windows = { { 1, 8 } };
  profile.temporal_sign = TemporalSign::onset;
  profile.illumination_guard = true;
  Image dark(10, 10);
  for (std::size_t i = 0; i < 100; ++i)
    dark.values[i] = 5 + static_cast<double>(i % 7);
  // Gains of the first ten samples and of all others: T_c / T_s = 8 g / (g + 7).
  const auto st = [&](double first, double others, bool guard = true) {
    profile.illumination_guard = guard;
    TemporalPyramid history(8, HistoryStart::filled);
    SpatiotemporalSaliency saliency(profile);
    history.push(oracle::to_mat(dark), 1, 1);
    Image lit = dark;
    for (std::size_t i = 0; i < 100; ++i)
      lit.values[i] *= i < 10 ? first : others;
    history.push(oracle::to_mat(lit), 1, 1);
    return to_image(saliency.compute(history));
  };
  // T_s ≥ 5 · 10/8 and T_c ≤ 11 · 3, so the error is at most 0.05 / T_s of T_c.
  fail_unless_at_most(st(3, 3).maximum(), 0.3);
  fail_unless(st(3, 3, false).maximum() > 15);

  const Image one_more = st(6, 3);
  const double beta = 8 * 3 / (3.0 + 7);
  for (std::size_t i = 0; i < 100; ++i)
    fail_unless_near(one_more.values[i], i < 10 ? dark.values[i] * (6 - beta * (6 + 7) / 8) : 0,
                     0.5);
  const Image only_one = st(6, 1);
  for (std::size_t i = 0; i < 100; ++i)
    fail_unless_near(only_one.values[i], i < 10 ? dark.values[i] * (6 - 13.0 / 8) : 0, 1e-4);
  // Darkening is not compensated: what appears meanwhile responds as in constant light.
  const Image darker = st(2, 0.5);
  for (std::size_t i = 0; i < 100; ++i)
    fail_unless_near(darker.values[i], i < 10 ? dark.values[i] * (2 - 9.0 / 8) : 0, 1e-4);
}
GST_END_TEST;

GST_START_TEST(test_smallest_lit_area)
{
  // A map with contrast on `count` of 100 samples. Up to 30 samples count as an object and respond.
  // More count as light if they had contrast before.
  for (const int count : { 30, 31 }) {
    Profile profile;
    profile.windows = { { 1, 8 } };
    profile.illumination_guard = true;
    TemporalPyramid history(8, HistoryStart::filled);
    SpatiotemporalSaliency saliency(profile);
    Image map(10, 10);
    for (const double value : { 8.0, 24.0 }) {
      std::fill_n(map.values.begin(), count, value);
      history.push(oracle::to_mat(map), 1, 1);
    }
    const double found = to_image(saliency.compute(history)).maximum();
    if (count <= 30)
      fail_unless_near(found, 24 - (24 + 7 * 8) / 8.0, 1e-4);
    else
      fail_unless_at_most(found, 0.2);
  }
}
GST_END_TEST;

GST_START_TEST(test_background)
{
  // An empty map takes the values 0, 1, … 100 in some order. Subtracting twice the median, 100 ·
  // 7/8, leaves nothing. Subtracting half of it leaves at most 75 · 7/8. At most the limit is
  // subtracted.
  Profile profile;
  profile.windows = { { 1, 8 } };
  profile.temporal_sign = TemporalSign::onset;
  profile.background_quantile = 0.5;
  for (const auto &[gain, limit] : { std::pair{ 0.0, 1e9 },
                                     { 0.5, 1e9 },
                                     { 1.0, 1e9 },
                                     { 2.0, 1e9 },
                                     { 2.0, 30.0 },
                                     { 0.5, 30.0 } }) {
    profile.background_gain = gain;
    profile.background_limit = limit;
    TemporalPyramid history(8, HistoryStart::filled);
    SpatiotemporalSaliency saliency(profile);
    Image map(101, 1);
    history.push(oracle::to_mat(map), 1, 1);
    for (int i = 0; i < 101; ++i)
      map(i, 0) = 37 * i % 101;
    history.push(oracle::to_mat(map), 1, 1);
    const Image st = to_image(saliency.compute(history));
    for (int i = 0; i < 101; ++i)
      fail_unless_near(
          st(i, 0), std::max(0.0, map(i, 0) * 7.0 / 8 - std::min(limit, 50 * gain * 7 / 8)), 1e-4);
  }
}
GST_END_TEST;

GST_START_TEST(test_dilation)
{
  cv::Mat along_rows;
  cv::Mat found;
  for (const auto &[width, height] : { std::pair{ 1, 1 }, { 1, 7 }, { 7, 1 }, { 13, 8 } })
    for (const int radius : { 0, 1, 2, 5, 20 }) {
      const Image map = oracle::random_image(width, height, 0, 9, static_cast<unsigned>(radius));
      saliency::dilate(oracle::to_mat(map), radius, along_rows, found);
      fail_unless_at_most(oracle::difference(found, dilated(map, radius)), 1e-6);
    }
}
GST_END_TEST;

static Suite *
spatiotemporal_saliency_suite(void)
{
  Suite *suite = suite_create("spatiotemporal_saliency");
  TCase *tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_test(tc, test_brute_force);
  tcase_add_test(tc, test_step);
  tcase_add_test(tc, test_ghost);
  tcase_add_test(tc, test_camera_and_background);
  tcase_add_test(tc, test_illumination);
  tcase_add_test(tc, test_smallest_lit_area);
  tcase_add_test(tc, test_background);
  tcase_add_test(tc, test_dilation);
  return suite;
}

GST_CHECK_MAIN(spatiotemporal_saliency);
