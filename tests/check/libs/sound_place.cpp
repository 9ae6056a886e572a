// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/place.h"
#include "sound/synthetic_sound.h"

#include <cmath>
#include <vector>

#include "support/tolerance.h"

#include "support/check_tests.h"

using namespace sound;

namespace {

/// The place of a sound that is panned there by constant power: cosine and sine.
Place
place_of_panned(double across, double behind, int channels)
{
  const auto speakers = usual_speakers(channels);
  std::vector<double> gains(speakers.size());
  pan(across, behind, speakers, gains);
  for (double &gain : gains)
    gain *= gain;
  return place_of(speakers, gains, 1);
}

} // namespace

CHECK_TEST(test_panned)
{
  for (const int channels : { 2, 6, 8 })
    for (const double across : { -1.0, -0.5, 0.0, 0.25, 1.0 }) {
      const Place front = place_of_panned(across, 0, channels);
      fail_unless_near(front.across, across, 1e-6);
      fail_unless_near(front.behind, 0, 1e-6);
      fail_unless_near(front.everywhere, 0, 1e-6);
      if (channels > 2) {
        const Place rear = place_of_panned(across, 1, channels);
        fail_unless_near(rear.across, across, 1e-6);
        fail_unless_near(rear.behind, 1, 1e-6);
      }
    }
}

CHECK_TEST(test_everywhere)
{
  const auto surround = usual_speakers(6);
  // The center and low frequency effects tell no place.
  fail_unless_near(place_of(surround, std::vector<double>{ 0, 0, 1, 0, 0, 0 }, 1).everywhere, 1,
                   1e-6);
  fail_unless_near(place_of(surround, std::vector<double>{ 0, 0, 0, 1, 0, 0 }, 1).everywhere, 1,
                   1e-6);
  fail_unless_near(place_of(surround, std::vector<double>{ 1, 0, 0, 1, 0, 0 }, 1).everywhere, 0.5,
                   1e-6);
  fail_unless_near(place_of(usual_speakers(1), std::vector<double>{ 1 }, 1).everywhere, 1, 1e-6);
  // Left and right have nothing in common, or opposite phases: it is all around.
  const auto stereo = usual_speakers(2);
  fail_unless_near(place_of(stereo, std::vector<double>{ 1, 1 }, 0).everywhere, 1, 1e-9);
  fail_unless_near(place_of(stereo, std::vector<double>{ 1, 1 }, -1).everywhere, 1, 1e-9);
  fail_unless_near(place_of(stereo, std::vector<double>{ 1, 0 }, 0).everywhere, 0, 1e-9);
  // Silence is nowhere in particular.
  fail_unless_near(place_of(stereo, std::vector<double>{ 0, 0 }, 1).everywhere, 1, 1e-6);
}

CHECK_TEST(test_cells)
{
  tactile::TactileMap map(3, 3);
  raise(map, { 1, 0, 0 }, false, 0.5F);
  for (int row = 0; row < 3; row++) {
    fail_unless_near(map.at(row, 0), 0, 1e-6);
    fail_unless_near(map.at(row, 1), 0, 1e-6);
    fail_unless_near(map.at(row, 2), 0.5, 1e-6);
  }
  // Behind: the bottom row. What is stronger stays.
  raise(map, { 1, 1, 0 }, true, 1);
  fail_unless_near(map.at(2, 2), 1, 1e-6);
  fail_unless_near(map.at(0, 2), 0.5, 1e-6);
  raise(map, { 0, 0, 1 }, true, 0.25F);
  fail_unless_near(map.at(0, 0), 0.25, 1e-6);
  fail_unless_near(map.at(2, 2), 1, 1e-6);

  tactile::TactileMap one(1, 1);
  raise(one, { -1, 1, 0 }, true, 0.5F);
  fail_unless_near(one.at(0, 0), 0.5, 1e-6);
}

// Any part, at any time, has the same bits.
CHECK_TEST(test_synthetic_is_a_function_of_time)
{
  const auto speakers = usual_speakers(2);
  const SyntheticSound made({ .seed = 7, .seconds = 4, .music = true });
  std::vector<float> whole(2 * 48000 * 4);
  made.render(48000, 0, speakers, whole);
  std::vector<float> part(2 * 1234);
  for (const std::int64_t first : { 0, 50001, 100000, 150007 }) {
    made.render(48000, first, speakers, part);
    for (std::size_t i = 0; i < part.size(); i++)
      fail_unless(part[i] == whole[static_cast<std::size_t>(first) * 2 + i]);
  }
}

// Music has the power that was asked for; what comes before it is silent.
CHECK_TEST(test_synthetic_power)
{
  const auto mono = usual_speakers(1);
  const SyntheticSound made({ .seed = 8, .seconds = 10, .impacts = false, .music = true });
  std::vector<float> frames(48000 * 10);
  made.render(48000, 0, mono, frames);
  double power = 0;
  for (const float sample : frames)
    power += static_cast<double>(sample) * static_cast<double>(sample);
  fail_unless_near(10 * std::log10(power / static_cast<double>(frames.size())), -20, 1);
  fail_unless_near(frames[48000 / 10], 0, 1e-6);
}

CHECK_MAIN(sound_place)
