// SPDX-License-Identifier: LGPL-2.1-or-later
#include "saliency/spatial_saliency.h"

#include "support/saliency_oracle.h"
#include "support/tolerance.h"

#include "support/check_tests.h"

using saliency::frame_levels;
using saliency::FrameLevels;
using saliency::LevelPair;
using saliency::Method;
using saliency::Profile;

namespace {

void
compare(const Profile &profile, int width, int height)
{
  std::vector<oracle::LabImage> levels{ oracle::picture_of_many_scales(
      width, height, static_cast<unsigned>(width * 100 + height)) };
  while (levels.back()[0].values.size() > 1)
    levels.push_back(oracle::pyr_down(levels.back()));

  const FrameLevels own = frame_levels(profile, { width, height });
  saliency::Pyramid pyramid;
  pyramid.build(oracle::to_planes(levels[static_cast<std::size_t>(own.finest)]), own.finest,
                own.coarsest);
  saliency::SpatialSaliency spatial(profile);
  const auto expected = oracle::spatial_saliency(levels, { own.lightness }, { own.chroma },
                                                 own.saliency, profile.chroma_weight, false);
  const double e = oracle::difference(spatial.compute(pyramid, own), expected);
  fail_unless(e <= 1e-3, "%dx%d: %g", width, height, e);
}

} // namespace

CHECK_TEST(test_reference_width)
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
    fail_unless((levels.lightness == LevelPair{ c.level_2, c.level_2 + 1 }),
                "%d wide: level 2 is %d", c.width, levels.lightness.center);
    fail_unless((levels.chroma == LevelPair{ c.level_2 + 1, c.level_2 + 2 })); // one level coarser
    ck_assert_int_eq(levels.saliency, c.level_2 + 2);
    ck_assert_int_eq(levels.finest, c.level_2);
    ck_assert_int_eq(levels.coarsest, c.level_2 + 2);
  }
  // A small frame starts at its own level 0. The pair keeps its δ while there are levels.
  auto levels = frame_levels(Profile::tuned(), { 16, 9 });
  fail_unless((levels.lightness == LevelPair{ 0, 1 }));
  ck_assert_int_eq(levels.saliency, 2);
  levels = frame_levels(Profile::tuned(), { 2, 1 });
  fail_unless((levels.lightness == LevelPair{ 0, 1 }));
  fail_unless((levels.chroma == LevelPair{ 1, 1 }));
  ck_assert_int_eq(levels.saliency, 1);
  levels = frame_levels(Profile::tuned(), { 1, 1 });
  fail_unless((levels.lightness == LevelPair{ 0, 0 }));
  ck_assert_int_eq(levels.saliency, 0);
}

CHECK_TEST(test_levels_of_paper)
{
  for (const int width : { 1000, 3840 }) {
    const auto levels = frame_levels(Profile::paper(), { width, 500 });
    ck_assert_int_eq(levels.saliency, 2);
    ck_assert_int_eq(levels.finest, 2);
    ck_assert_int_eq(levels.finest_chroma, 2);
    ck_assert_int_eq(levels.coarsest, 8);
  }
  ck_assert_int_eq(frame_levels(Profile::paper(), { 64, 48 }).coarsest, 6); // 64×48 has no more
  ck_assert_int_eq(frame_levels(Profile::paper(), { 2, 1 }).finest, 1);
}

CHECK_TEST(test_brute_force)
{
  // Centers finer than the map, equal to it and coarser, in the frame's levels and renumbered.
  Profile profile = Profile::tuned();
  for (const int reference : { 0, 20, 220 })
    for (const auto &[width, height] : { std::pair{ 1, 1 },
                                         { 1, 30 },
                                         { 30, 1 },
                                         { 5, 1 },
                                         { 3, 2 },
                                         { 33, 21 },
                                         { 64, 48 },
                                         { 100, 75 } })
      for (const int level : { 0, 2, 4 })
        for (const LevelPair pair : { LevelPair{ 2, 5 }, { 1, 2 }, { 0, 3 }, { 3, 4 }, { 2, 3 } }) {
          profile.reference_width = reference;
          profile.saliency_level = level;
          profile.chroma_weight = 1 + level;
          profile.chroma_octaves = level / 2;
          profile.levels = pair;
          compare(profile, width, height);
        }
}

CHECK_TEST(test_tuned_spatial)
{
  // At a width of 100 pixels everything is at the frame's level 0. At 220 it is at level 1.
  for (const auto &[width, height] : { std::pair{ 1, 1 }, { 5, 1 }, { 100, 75 }, { 220, 40 } }) {
    auto lab = oracle::picture_of_many_scales(width, height, 5);
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

CHECK_TEST(test_surroundedness_at_other_levels)
{
  // Surroundedness finer than the map, and coarser; rarity at the coarsest level in use.
  const auto fine = oracle::picture_of_many_scales(64, 48, 9);
  const auto middle = oracle::pyr_down(fine);
  const auto coarse = oracle::pyr_down(middle);
  const auto expect = [&](LevelPair levels, const oracle::Image &surrounded,
                          const oracle::Image &rare) {
    oracle::Image expected(32, 24);
    for (std::size_t i = 0; i < expected.values.size(); ++i)
      expected.values[i] = surrounded.values[i] * rare.values[i];
    const Profile profile{ .method = Method::pictures,
                           .reference_width = 0,
                           .levels = levels,
                           .threshold_step = 3,
                           .area_exponent = 0.25,
                           .saliency_level = 1 };
    const FrameLevels own = frame_levels(profile, { 64, 48 });
    saliency::Pyramid pyramid;
    pyramid.build(oracle::to_planes(own.finest == 0 ? fine : middle), own.finest, own.coarsest);
    saliency::SpatialSaliency spatial(profile);
    fail_unless_at_most(oracle::difference(spatial.compute(pyramid, own), expected),
                        1e-4 * expected.maximum());
  };
  const auto rare = oracle::up(oracle::rarity(coarse, 0), 1, 1, 32, 24);
  expect({ 0, 2 }, oracle::pyr_down(oracle::surroundedness(fine, 3, 0.25)), rare);
  expect({ 2, 2 }, oracle::up(oracle::surroundedness(coarse, 3, 0.25), 1, 1, 32, 24), rare);
  expect({ 1, 1 }, oracle::surroundedness(middle, 3, 0.25), oracle::rarity(middle, 0));
}

CHECK_TEST(test_flat_picture)
{
  const oracle::LabImage gray{ oracle::Image(40, 30, 53.6), oracle::Image(40, 30, 1e-5),
                               oracle::Image(40, 30, -2e-5) };
  for (const auto &profile : { Profile::tuned(), Profile::tuned_spatial() }) {
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

CHECK_MAIN(spatial_saliency)
