// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/spatial_saliency.h"

#include "support/saliency_oracle.h"
#include "support/tolerance.h"

using saliency::frame_levels;
using saliency::FrameLevels;
using saliency::LevelPair;
using saliency::Normalization;
using saliency::Profile;

namespace {

bool
same(const std::vector<LevelPair> &a, const std::vector<LevelPair> &b)
{
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const LevelPair &p, const LevelPair &q) {
                      return p.center == q.center && p.surround == q.surround;
                    });
}

/// A picture with structure at several scales.
oracle::LabImage
picture(int width, int height, unsigned seed)
{
  oracle::LabImage lab;
  for (std::size_t c = 0; c < 3; ++c) {
    lab[c] = oracle::random_image(width, height, c == 0 ? 20 : -30, c == 0 ? 60 : 30,
                                  seed + static_cast<unsigned>(c));
    const auto coarse = oracle::random_image((width + 7) / 8, (height + 7) / 8, -20, 30,
                                             seed + 10 + static_cast<unsigned>(c));
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        lab[c](x, y) += coarse(x / 8, y / 8);
  }
  return lab;
}

void
compare(const Profile &profile, int width, int height)
{
  std::vector<oracle::LabImage> levels{ picture(width, height,
                                                static_cast<unsigned>(width * 100 + height)) };
  while (levels.back()[0].values.size() > 1)
    levels.push_back(oracle::pyr_down(levels.back()));

  const FrameLevels own = frame_levels(profile, { width, height });
  saliency::Pyramid pyramid;
  pyramid.build(oracle::to_planes(levels[static_cast<std::size_t>(own.finest)]), own.finest,
                own.coarsest);
  saliency::SpatialSaliency spatial(profile);
  const auto expected = oracle::spatial_saliency(
      levels, own.pairs, own.chroma, own.saliency, profile.chroma_weight,
      profile.contrast_normalization == Normalization::itti, profile.contrast_mean);
  const double e = oracle::difference(spatial.compute(pyramid, own), expected);
  fail_unless(e <= 1e-3, "%dx%d: %g", width, height, e);
}

} // namespace

GST_START_TEST(test_reference_width)
{
  // Level 2 of the tuned profile is the level whose width is nearest to 220 pixels in octaves. The
  // pair and the map follow it.
  const struct
  {
    int width;
    int level_2;
  } cases[]
      = { { 160, 0 }, { 220, 0 },  { 310, 0 },  { 320, 1 },  { 622, 1 },  { 623, 2 }, { 640, 2 },
          { 854, 2 }, { 1000, 2 }, { 1280, 3 }, { 1920, 3 }, { 3840, 4 }, { 7680, 5 } };
  for (const auto &c : cases) {
    const auto levels = frame_levels(Profile::tuned(), { c.width, c.width });
    fail_unless(same(levels.pairs, { { c.level_2, c.level_2 + 1 } }), "%d wide: level 2 is %d",
                c.width, levels.pairs[0].center);
    fail_unless(same(levels.chroma, { { c.level_2 + 1, c.level_2 + 2 } })); // one level coarser
    ck_assert_int_eq(levels.saliency, c.level_2 + 2);
    ck_assert_int_eq(levels.finest, c.level_2);
    ck_assert_int_eq(levels.coarsest, c.level_2 + 2);
  }
  // A small frame starts at its own level 0. The pair keeps its δ while there are levels.
  auto levels = frame_levels(Profile::tuned(), { 16, 9 });
  fail_unless(same(levels.pairs, { { 0, 1 } }));
  ck_assert_int_eq(levels.saliency, 2);
  levels = frame_levels(Profile::tuned(), { 2, 1 });
  fail_unless(same(levels.pairs, { { 0, 1 } }));
  fail_unless(same(levels.chroma, { { 1, 1 } }));
  ck_assert_int_eq(levels.saliency, 1);
  levels = frame_levels(Profile::tuned(), { 1, 1 });
  fail_unless(same(levels.pairs, { { 0, 0 } }));
  ck_assert_int_eq(levels.saliency, 0);
}
GST_END_TEST;

GST_START_TEST(test_levels_without_reference)
{
  for (const int width : { 1000, 3840 }) {
    const auto levels = frame_levels(Profile::paper(), { width, 500 });
    fail_unless(same(levels.pairs, { { 2, 5 }, { 2, 6 }, { 3, 6 }, { 3, 7 }, { 4, 7 }, { 4, 8 } }));
    ck_assert_int_eq(levels.saliency, 2);
    ck_assert_int_eq(levels.finest, 2);
    ck_assert_int_eq(levels.coarsest, 8);
  }
  // 64×48 has levels 0…6, which limit the surrounds.
  const auto small = frame_levels(Profile::paper(), { 64, 48 });
  fail_unless(same(small.pairs, { { 2, 5 }, { 2, 6 }, { 3, 6 }, { 3, 6 }, { 4, 6 }, { 4, 6 } }));
}
GST_END_TEST;

GST_START_TEST(test_brute_force)
{
  // Centers finer than the map, equal to it and coarser. Sums and means, with N and without.
  Profile profile;
  profile.windows = { { 1, 8 } };
  for (const auto &[width, height] :
       { std::pair{ 1, 1 }, { 1, 30 }, { 30, 1 }, { 3, 2 }, { 33, 21 }, { 64, 48 } })
    for (const Normalization normalization : { Normalization::none, Normalization::itti })
      for (const bool mean : { false, true })
        for (const int level : { 0, 2, 4 }) {
          profile.contrast_normalization = normalization;
          profile.contrast_mean = mean;
          profile.saliency_level = level;
          profile.chroma_weight = 1 + level;
          profile.levels = { { 2, 5 }, { 1, 2 }, { 0, 3 }, { 3, 4 } };
          compare(profile, width, height);
          profile.levels = { { 2, 3 } };
          compare(profile, width, height);
        }
}
GST_END_TEST;

GST_START_TEST(test_profiles)
{
  for (const auto &profile : { Profile::paper(), Profile::tuned() })
    for (const auto &[width, height] : { std::pair{ 1, 1 }, { 5, 1 }, { 64, 48 }, { 100, 75 } })
      compare(profile, width, height);
}
GST_END_TEST;

GST_START_TEST(test_tuned_spatial)
{
  // At a width of 100 pixels everything is at the frame's level 0. At 220 it is at level 1.
  for (const auto &[width, height] : { std::pair{ 1, 1 }, { 5, 1 }, { 100, 75 }, { 220, 40 } }) {
    auto lab = picture(width, height, 5);
    for (int n = 0; n < (width == 220 ? 1 : 0); ++n)
      lab = oracle::pyr_down(lab);
    auto expected = oracle::surroundedness(lab, 3, 0.5);
    const auto rarity = oracle::rarity(lab, 0);
    for (std::size_t i = 0; i < expected.values.size(); ++i)
      expected.values[i] *= rarity.values[i];

    const Profile profile = Profile::tuned_spatial();
    const FrameLevels levels = frame_levels(profile, { width, height });
    saliency::Pyramid pyramid;
    pyramid.build(oracle::to_planes(lab), levels.finest, levels.coarsest);
    saliency::SpatialSaliency spatial(profile);
    const auto &map = spatial.compute(pyramid, levels);
    const double e = oracle::difference(map, expected);
    fail_unless(e <= 1e-4 * expected.maximum(), "%dx%d: %g of %g", width, height, e,
                expected.maximum());
  }
}
GST_END_TEST;

GST_START_TEST(test_cue_and_rarity_at_other_levels)
{
  // Surroundedness at two levels, one coarser and one finer than the map. Rarity at the coarser
  // one.
  Profile profile;
  profile.spatial_cue = saliency::SpatialCue::surroundedness;
  profile.levels = { { 0, 1 }, { 2, 2 } };
  profile.saliency_level = 1;
  profile.contrast_mean = true;
  profile.rarity = true;
  profile.threshold_step = 3;
  profile.area_exponent = 0.25;
  const auto fine = picture(64, 48, 9);
  const auto middle = oracle::pyr_down(fine);
  const auto coarse = oracle::pyr_down(middle);
  const auto a = oracle::pyr_down(oracle::surroundedness(fine, 3, 0.25));
  const auto b = oracle::up(oracle::surroundedness(coarse, 3, 0.25), 1, 1, 32, 24);
  const auto r = oracle::up(oracle::rarity(coarse, 0), 1, 1, 32, 24);
  oracle::Image expected(32, 24);
  for (std::size_t i = 0; i < expected.values.size(); ++i)
    expected.values[i] = 0.5 * (a.values[i] + b.values[i]) * r.values[i];

  const FrameLevels levels = frame_levels(profile, { 64, 48 });
  saliency::Pyramid pyramid;
  pyramid.build(oracle::to_planes(fine), levels.finest, levels.coarsest);
  saliency::SpatialSaliency spatial(profile);
  fail_unless_at_most(oracle::difference(spatial.compute(pyramid, levels), expected),
                      1e-4 * expected.maximum());
}
GST_END_TEST;

GST_START_TEST(test_flat_picture)
{
  const oracle::LabImage gray{ oracle::Image(40, 30, 53.6), oracle::Image(40, 30, 1e-5),
                               oracle::Image(40, 30, -2e-5) };
  for (const auto &profile : { Profile::paper(), Profile::tuned(), Profile::tuned_spatial() }) {
    const auto levels = frame_levels(profile, { 40, 30 });
    auto level = gray;
    for (int n = 0; n < levels.finest; ++n)
      level = oracle::pyr_down(level);
    saliency::Pyramid pyramid;
    pyramid.build(oracle::to_planes(level), levels.finest, levels.coarsest);
    saliency::SpatialSaliency spatial(profile);
    fail_unless_at_most(cv::norm(spatial.compute(pyramid, levels), cv::NORM_INF), 1e-4);
  }
}
GST_END_TEST;

static Suite *
spatial_saliency_suite(void)
{
  Suite *suite = suite_create("spatial_saliency");
  TCase *tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_test(tc, test_reference_width);
  tcase_add_test(tc, test_levels_without_reference);
  tcase_add_test(tc, test_brute_force);
  tcase_add_test(tc, test_profiles);
  tcase_add_test(tc, test_tuned_spatial);
  tcase_add_test(tc, test_cue_and_rarity_at_other_levels);
  tcase_add_test(tc, test_flat_picture);
  return suite;
}

GST_CHECK_MAIN(spatial_saliency);
