// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/spatiotemporal_saliency.h"

#include "saliency_oracle.h"
#include "tolerance.h"

using oracle::Image;
using saliency::HistoryStart;
using saliency::Normalization;
using saliency::Profile;
using saliency::SpatiotemporalSaliency;
using saliency::TemporalPyramid;
using saliency::TemporalSign;

namespace {

/// ST of a film of maps, one frame each, by its definition.
Image
expected(const Profile &profile, const std::vector<Image> &maps)
{
  const auto mean = [&](int window) {
    Image sum(maps[0].width, maps[0].height);
    for (int k = 0; k < window; ++k) {
      // Before the first map: for ever that map.
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

/// ST of one pixel over a film of one pixel.
std::vector<double>
course(TemporalSign sign, const std::vector<double> &values)
{
  Profile profile = Profile::tuned();
  profile.temporal_sign = sign;
  profile.illumination_guard = false; // one pixel is the whole map
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
  // A pixel that steps from 0 to 80: after k frames T_w is 80 min(1, k/w), in closed form.
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
  fail_unless_near(st[89], 0, 0);                                                      // and over
}
GST_END_TEST;

GST_START_TEST(test_ghost)
{
  // What has been there for long and goes away: nothing to an onset, a ghost of 64 frames to the
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

static Suite *
spatiotemporal_saliency_suite(void)
{
  Suite *suite = suite_create("spatiotemporal_saliency");
  TCase *tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_test(tc, test_brute_force);
  tcase_add_test(tc, test_step);
  tcase_add_test(tc, test_ghost);
  return suite;
}

GST_CHECK_MAIN(spatiotemporal_saliency);
