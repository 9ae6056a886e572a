// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/spatiotemporal_saliency.h"

#include "support/saliency_oracle.h"
#include "support/tolerance.h"

#include <algorithm>
#include <cmath>

using oracle::Image;
using saliency::Normalization;
using saliency::Profile;
using saliency::SpatiotemporalSaliency;
using saliency::TemporalPyramid;

namespace {

/// ST of a sequence of maps by its definition.
Image
expected(const Profile &profile, const std::vector<Image> &maps)
{
  const auto mean = [&](int window) {
    Image sum(maps[0].width, maps[0].height);
    const std::size_t count = std::min(maps.size(), static_cast<std::size_t>(window));
    for (std::size_t i = maps.size() - count; i < maps.size(); ++i)
      for (std::size_t p = 0; p < sum.values.size(); ++p)
        sum.values[p] += maps[i].values[p] / static_cast<double>(count);
    return sum;
  };
  Image saliency(maps[0].width, maps[0].height);
  for (const auto &pair : profile.windows) {
    const Image center = mean(pair.center);
    const Image surround = mean(pair.surround);
    for (std::size_t p = 0; p < saliency.values.size(); ++p)
      saliency.values[p] += std::abs(center.values[p] - surround.values[p]);
  }
  return profile.temporal_normalization == Normalization::itti ? oracle::itti(saliency) : saliency;
}

} // namespace

GST_START_TEST(test_brute_force)
{
  for (const auto normalization : { Normalization::none, Normalization::itti }) {
    Profile profile;
    profile.windows = { { 1, 8 }, { 1, 16 }, { 2, 16 }, { 8, 64 }, { 16, 4 } };
    profile.temporal_normalization = normalization;
    TemporalPyramid history(64);
    SpatiotemporalSaliency saliency(profile);
    std::vector<Image> maps;
    for (unsigned i = 0; i < 90; ++i) {
      maps.push_back(oracle::random_image(7, 6, 0, 60, i));
      history.push(oracle::to_mat(maps.back()));
      fail_unless_at_most(oracle::difference(saliency.compute(history), expected(profile, maps)),
                          1e-4);
    }
  }
}
GST_END_TEST;

GST_START_TEST(test_ghost)
{
  // A ball that has long been there vanishes: the paper's windows have a ghost of 64 frames.
  Profile profile = Profile::paper();
  profile.temporal_normalization = Normalization::none;
  TemporalPyramid history(64);
  SpatiotemporalSaliency saliency(profile);
  for (int i = 0; i < 200; ++i) {
    history.push(oracle::to_mat(Image(1, 1, i < 100 ? 80 : 0)));
    const float found = saliency.compute(history).at<float>(0);
    fail_unless(i >= 100 && i < 163 ? found > 0.1F : found == 0, "frame %d: %g", i,
                static_cast<double>(found));
  }
}
GST_END_TEST;

static Suite *
spatiotemporal_saliency_suite(void)
{
  Suite *suite = suite_create("spatiotemporal saliency");
  TCase *tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_test(tc, test_brute_force);
  tcase_add_test(tc, test_ghost);
  return suite;
}

GST_CHECK_MAIN(spatiotemporal_saliency);
